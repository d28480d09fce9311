"""Governors of all kinds, as scenes have them."""

WATT = {"type": "watt_governor", "ball_mass": 3.0, "upper_arm": 0.3, "lower_arm": 0.3, "least_radius": 0.1,
        "greatest_radius": 0.2}  # fmt: skip
PORTER = {"type": "porter_governor", "ball_mass": 5.0, "sleeve_mass": 25.0, "upper_arm": 0.25, "lower_arm": 0.25,
          "least_radius": 0.15, "greatest_radius": 0.2}  # fmt: skip
PROELL = {"type": "proell_governor", "ball_mass": 10.0, "sleeve_mass": 100.0, "upper_arm": 0.3, "lower_arm": 0.3,
          "extension": 0.08, "parallel_radius": 0.15, "least_radius": 0.17, "greatest_radius": 0.2}  # fmt: skip
HARTNELL = {"type": "hartnell_governor", "ball_mass": 2.5, "ball_arm": 0.12, "sleeve_arm": 0.08, "pivot_radius": 0.12,
            "least_radius": 0.12, "greatest_radius": 0.1425, "stiffness": 19.8e3, "preload": 831.0}  # fmt: skip
TABLE = {"type": "table_governor", "ball_mass": 2.5, "sleeve_mass": 3.0, "lift_ratio": 0.66, "interpolation": "pchip",
         "over_radius": [0.1, 0.12, 0.13, 0.15], "controlling_force": [190.0, 277.0, 330.0, 450.0],
         "least_radius": 0.12, "greatest_radius": 0.1425}  # fmt: skip
ENGINE = {"inertia": 20.0, "throttle": {"type": "linear", "full": 400.0}, "load": 300.0, "new_load": 150.0}
EVERY_GOVERNOR = {"watt": WATT, "porter": PORTER, "proell": PROELL, "hartnell": HARTNELL, "table": TABLE}
