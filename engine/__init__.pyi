"""The public names of the engine: their only list, for type checkers, editors and `door`.

An import with `as` publishes a name under one that is clear outside its module.
"""

from engine.compiling.kept_code import is_compiling
from engine.compiling.sources import sources_digest
from engine.compiling.threads import set_threads, threads
from engine.cycle.turning_moment import TurningMoment, turning_moment_from_areas, turning_moment_from_table
from engine.elements.bodies.rotating_guide import RotatingGuide
from engine.elements.bodies.tethered_body import TetheredBody
from engine.elements.bodies.tilted_body import TiltedBody, body_ellipsoid
from engine.elements.bodies.wound_flywheel import wound_stresses
from engine.elements.cams.cam import CamElement
from engine.elements.cams.cam_curves import CamCurves, cam_curves
from engine.elements.compliances.compliance import ComplianceElement
from engine.elements.element import Element, element_kinds
from engine.elements.engines.engine import SHOWN_ORDERS, EngineElement, shaken, torque_orders
from engine.elements.engines.engine_layout import (
    Engine,
    EngineLayout,
    MasterRod,
    boxer_engine,
    in_line_engine,
    radial_engine,
    usual_throws,
    v_engine,
    w_engine,
)
from engine.elements.engines.engine_torque import engine_torque, made_engine
from engine.elements.engines.firing import FOUR_STROKE, even_firing_order, firing_angles, firing_intervals, firing_sums
from engine.elements.engines.harmonics import crank_radius, piston_harmonics
from engine.elements.engines.hodograph import Hodograph
from engine.elements.engines.shafts import balance_shafts, crankshaft_counterweights, remaining_shaking
from engine.elements.engines.shaking import SHAKING_ORDERS, EngineShaking, engine_shaking
from engine.elements.gears.chain_drive import ChainDrive
from engine.elements.gears.gear_train import GearTrain
from engine.elements.gears.train_results import train_results
from engine.elements.gears.velocity_picture import DrawnWheel, VelocityPicture, velocity_picture
from engine.elements.governors.governor import Governor
from engine.elements.panels import Curve, Mark, Panel, PanelAxis
from engine.elements.rotors.correction import corrected_unbalance
from engine.elements.rotors.grades import permissible_unbalance, tolerance_shares
from engine.elements.rotors.hole_pattern import PatternError, split_on_neighbours
from engine.elements.rotors.influence import (
    four_runs,
    influence_coefficients,
    influence_correction,
    residual_confidence,
)
from engine.elements.rotors.rotor import RotorElement
from engine.elements.rotors.static_rotor import StaticRotor
from engine.elements.rotors.unbalance import resultant_unbalance, unbalance_in_two_planes
from engine.elements.torsional_trains.excitation import train_speed
from engine.elements.torsional_trains.holzer import HolzerTable, holzer_table
from engine.elements.torsional_trains.natural_frequencies import natural_vibration
from engine.elements.torsional_trains.reduced_train import ReducedTrain, reduced_train
from engine.elements.torsional_trains.torsional_train import TorsionalTrain
from engine.laws.friction.guides import edge_forces as guide_edge_forces
from engine.laws.tables import TableError
from engine.machine.asked_quantities import ACCURACY_REACHED, POSITIONS_USED
from engine.machine.asked_quantities import OF_ACCURACY as ACCURACY_SUMMARIES
from engine.machine.balancing.counterweights import BalancedMachine, BalanceError, CounterweightPlace, balance
from engine.machine.checks import check_scene, full_names, given_numbers, names_of, outside_limits
from engine.machine.derivatives import EVALUATIONS as EVALUATIONS_PER_DERIVATIVE
from engine.machine.derivatives import PLACES as PLACE_STATISTICS
from engine.machine.derivatives import Derivatives, Move, derivatives_along, scale_of, unit_over
from engine.machine.drives.elastic_drives import DriveCycle, DriveRun, drive_cycle, drive_run
from engine.machine.drives.governed_scene import governed_scene
from engine.machine.elements.elements_alone import ElementsAlone, made_ready
from engine.machine.machine import Machine, numbers_for_trains, seconds_of_runs
from engine.machine.one_machine.assembly_modes import assembly_modes, assembly_ranges, near_of_variant
from engine.machine.one_machine.history import History, history, history_fields
from engine.machine.one_machine.moving_machine import Motions, MovingMachine, NowhereDefinedError
from engine.machine.one_machine.warned_machine import summaries_for_warnings, warnings_in_words
from engine.machine.results import AskError, Outcome
from engine.mechanism.assembly import MovingPoint
from engine.mechanism.groups.seed_tables import AssemblyMode
from engine.mechanism.link_loads import LinkForce
from engine.mechanism.mechanics import Mechanics
from engine.motion.cases import regime_text
from engine.motion.quantities import of_sliding as sliding_quantity
from engine.motion.quantities import sized_regimes
from engine.parts.actions import Brake, TorsionSpring
from engine.parts.formulas.by_formula import FormulaNumber
from engine.parts.formulas.dimension_check import (
    check_yields,
    dimension_of,
    dimensions_by_unit,
    unit_of_dimension,
)
from engine.parts.formulas.expressions import (
    ExpressionError,
    TextExpression,
    TextOperation,
    apply_operation,
    evaluate_tree,
    joined_by_and,
)
from engine.parts.formulas.expressions import Tree as ExpressionTree
from engine.parts.formulas.expressions import parse as parse_expression
from engine.parts.higher_pairs import DrivingCam, NoncircularWheel, Pinion, Rack
from engine.parts.motors import DCMotor, InductionMotor
from engine.parts.regimes import Regime, RunRegime, SteadyRegime, run_keys
from engine.parts.second_inputs import SecondCrank, SecondSlider
from engine.parts.skeleton import (
    FRAME,
    RPP,
    RPR,
    CrankInput,
    Hinged,
    Near,
    NonZero,
    PlainText,
    Sliding,
    Yoke,
    field_dimension,
    field_marks,
)
from engine.parts.skeleton import Number as PlainNumber
from engine.parts.skeleton import Part as ScenePart
from engine.quantities.register import InputUnits, drive_words
from engine.scene.attachments import guide_of, places_on
from engine.scene.names import definitions as definitions_of_names
from engine.scene.pairs import Pair, holder_of, mesh_driver
from engine.scene.pairs import pairs as pairs_of
from engine.scene.scene import Scene, SceneError, allowed_text, scene_numbers
from engine.scene.structure.free_groups import FreeGroup
from engine.scene.structure.mobility import mobility
from engine.scene.structure.ordering import group_links
from engine.scene.structure.ordering import order as order_groups
from engine.scene.structure.ordering import sliders as sliders_of
from engine.scene.structure.trains import mesh_axis
from engine.scene.wrong_input import MOST_PROBLEMS, arms_of, bare_annotation, is_union, wrong_input
from engine.units.dimensions import DIMENSIONS, Powers, common_units
from engine.units.dimensions import described as described_dimension
from engine.units.display import (
    UnitSystem,
    display_unit,
    figure_text,
    quantity_text,
    show_errors,
    show_system,
    show_units,
    show_units_of,
    table_unit,
    unit_label,
    units_shown,
)
from engine.units.reading import (
    UnitError,
    any_quantity,
    column_in_text,
    comma_advice,
    dimension_of_unit,
    even_steps,
    first_last_count,
    in_text,
    recognised,
    shortened,
    text_pattern,
    unit_in,
)
from engine.units.standard_sizes import STANDARD_SIZES
from engine.warnings import is_warning
from engine.warnings.kinds import KINDS as WARNING_KINDS
from engine.words.quantity import STATISTICS, Quantity, Rank
from engine.words.user_error import UserError
from engine.words.verdicts import Verdict

__version__: str
from engine.words.glossary import counted, did_you_mean, enumerated, speaks_of, unknown_name_message
from engine.words.glossary import nearest as nearest_names

__all__ = [
    "ACCURACY_REACHED",
    "ACCURACY_SUMMARIES",
    "DIMENSIONS",
    "EVALUATIONS_PER_DERIVATIVE",
    "FOUR_STROKE",
    "FRAME",
    "MOST_PROBLEMS",
    "PLACE_STATISTICS",
    "POSITIONS_USED",
    "RPP",
    "RPR",
    "SHAKING_ORDERS",
    "SHOWN_ORDERS",
    "STANDARD_SIZES",
    "STATISTICS",
    "WARNING_KINDS",
    "AskError",
    "AssemblyMode",
    "BalanceError",
    "BalancedMachine",
    "Brake",
    "CamCurves",
    "CamElement",
    "ChainDrive",
    "ComplianceElement",
    "CounterweightPlace",
    "CrankInput",
    "Curve",
    "DCMotor",
    "Derivatives",
    "DrawnWheel",
    "DriveCycle",
    "DriveRun",
    "DrivingCam",
    "Element",
    "ElementsAlone",
    "Engine",
    "EngineElement",
    "EngineLayout",
    "EngineShaking",
    "ExpressionError",
    "ExpressionTree",
    "FormulaNumber",
    "FreeGroup",
    "GearTrain",
    "Governor",
    "Hinged",
    "History",
    "Hodograph",
    "HolzerTable",
    "InductionMotor",
    "InputUnits",
    "LinkForce",
    "Machine",
    "Mark",
    "MasterRod",
    "Mechanics",
    "Motions",
    "Move",
    "MovingMachine",
    "MovingPoint",
    "Near",
    "NonZero",
    "NoncircularWheel",
    "NowhereDefinedError",
    "Outcome",
    "Pair",
    "Panel",
    "PanelAxis",
    "PatternError",
    "Pinion",
    "PlainNumber",
    "PlainText",
    "Powers",
    "Quantity",
    "Rack",
    "Rank",
    "ReducedTrain",
    "Regime",
    "RotatingGuide",
    "RotorElement",
    "RunRegime",
    "Scene",
    "SceneError",
    "ScenePart",
    "SecondCrank",
    "SecondSlider",
    "Sliding",
    "StaticRotor",
    "SteadyRegime",
    "TableError",
    "TetheredBody",
    "TextExpression",
    "TextOperation",
    "TiltedBody",
    "TorsionSpring",
    "TorsionalTrain",
    "TurningMoment",
    "UnitError",
    "UnitSystem",
    "UserError",
    "VelocityPicture",
    "Verdict",
    "Yoke",
    "allowed_text",
    "any_quantity",
    "apply_operation",
    "arms_of",
    "assembly_modes",
    "assembly_ranges",
    "balance",
    "balance_shafts",
    "bare_annotation",
    "body_ellipsoid",
    "boxer_engine",
    "cam_curves",
    "check_scene",
    "check_yields",
    "column_in_text",
    "comma_advice",
    "common_units",
    "corrected_unbalance",
    "counted",
    "crank_radius",
    "crankshaft_counterweights",
    "definitions_of_names",
    "derivatives_along",
    "described_dimension",
    "did_you_mean",
    "dimension_of",
    "dimension_of_unit",
    "dimensions_by_unit",
    "display_unit",
    "drive_cycle",
    "drive_run",
    "drive_words",
    "element_kinds",
    "engine_shaking",
    "engine_torque",
    "enumerated",
    "evaluate_tree",
    "even_firing_order",
    "even_steps",
    "field_dimension",
    "field_marks",
    "figure_text",
    "firing_angles",
    "firing_intervals",
    "firing_sums",
    "first_last_count",
    "four_runs",
    "full_names",
    "given_numbers",
    "governed_scene",
    "group_links",
    "guide_edge_forces",
    "guide_of",
    "history",
    "history_fields",
    "holder_of",
    "holzer_table",
    "in_line_engine",
    "in_text",
    "influence_coefficients",
    "influence_correction",
    "is_compiling",
    "is_union",
    "is_warning",
    "joined_by_and",
    "made_engine",
    "made_ready",
    "mesh_axis",
    "mesh_driver",
    "mobility",
    "names_of",
    "natural_vibration",
    "near_of_variant",
    "nearest_names",
    "numbers_for_trains",
    "order_groups",
    "outside_limits",
    "pairs_of",
    "parse_expression",
    "permissible_unbalance",
    "piston_harmonics",
    "places_on",
    "quantity_text",
    "radial_engine",
    "recognised",
    "reduced_train",
    "regime_text",
    "remaining_shaking",
    "residual_confidence",
    "resultant_unbalance",
    "run_keys",
    "scale_of",
    "scene_numbers",
    "seconds_of_runs",
    "set_threads",
    "shaken",
    "shortened",
    "show_errors",
    "show_system",
    "show_units",
    "show_units_of",
    "sized_regimes",
    "sliders_of",
    "sliding_quantity",
    "sources_digest",
    "speaks_of",
    "split_on_neighbours",
    "summaries_for_warnings",
    "table_unit",
    "text_pattern",
    "threads",
    "tolerance_shares",
    "torque_orders",
    "train_results",
    "train_speed",
    "turning_moment_from_areas",
    "turning_moment_from_table",
    "unbalance_in_two_planes",
    "unit_in",
    "unit_label",
    "unit_of_dimension",
    "unit_over",
    "units_shown",
    "unknown_name_message",
    "usual_throws",
    "v_engine",
    "velocity_picture",
    "w_engine",
    "warnings_in_words",
    "wound_stresses",
    "wrong_input",
]
