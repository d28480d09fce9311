"""The flywheel as a wheel, and flywheels straight from turning-moment diagrams."""
