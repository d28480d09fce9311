"""The register of warnings: every kind, with its name, its meaning, and its rules for the parts of a scene."""

from engine.scene.scene import Scene, once
from engine.warnings import flywheel_rules, link_rules, load_rules
from engine.warnings.rule import Rule, WarningKind

KINDS = (
    WarningKind("rim_speed", "rim speed of the flywheel above its limit", flywheel_rules.rim_speed_rules),
    WarningKind("hoop_stress", "hoop stress in the flywheel above its strength", flywheel_rules.hoop_stress_rules),
    WarningKind("rim_width", "rim of the flywheel narrower than its limit", flywheel_rules.rim_width_rules),
    WarningKind("negative_flywheel", "flywheel inertia below 0", flywheel_rules.negative_flywheel_rules),
    WarningKind("flywheel_ratio", "flywheel far above the machine's inertia", flywheel_rules.flywheel_ratio_rules),
    WarningKind("run_flywheel", "run without the flywheel that is sized", flywheel_rules.run_flywheel_rules),
    WarningKind("clearance", "clearance volume above its limit", load_rules.clearance_rules),
    WarningKind("discharge", "compressor that never reaches its discharge pressure", load_rules.discharge_rules),
    WarningKind("suction", "pump that the liquid drives", load_rules.suction_rules),
    WarningKind("friction", "coefficient of friction above its limit", load_rules.friction_rules),
    WarningKind("loose_belt", "belt too fast for its tension", load_rules.loose_belt_rules),
    WarningKind("unused_load", "load that never acts", load_rules.unused_load_rules),
    WarningKind("motor_torque", "rms torque of a motor above its rated torque", load_rules.motor_rules),
    WarningKind("transmission_angle", "transmission angle below its limit", link_rules.transmission_rules),
    WarningKind("slenderness", "slender rod in compression", link_rules.slenderness_rules),
    WarningKind("massless_link", "link with forces but without mass", link_rules.massless_link_rules),
    WarningKind("no_masses", "loads on a machine without masses", link_rules.no_masses_rules),
    WarningKind("undercut", "wheel with undercut teeth", link_rules.undercut_rules),
)


@once
def rules_by_kind(scene: Scene) -> dict[str, tuple[Rule, ...]]:
    """Rules of the kinds of warnings that a scene may have, by the names of the kinds."""
    found = {kind.name: tuple(kind.rules(scene)) for kind in KINDS}
    return {name: rules for name, rules in found.items() if rules}
