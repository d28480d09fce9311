"""Pictures of the machine elements of a scene: rotors, engines, governors, springs, gears, cams; and their tables."""

from pathlib import Path

from engine import (
    CamElement,
    CarElement,
    ChainDrive,
    ComplianceElement,
    EngineElement,
    GearTrain,
    Governor,
    LocomotiveElement,
    MachineDrive,
    OscillatorElement,
    RotatingGuide,
    RotorElement,
    Scene,
    StaticRotor,
    TetheredBody,
    TiltedBody,
    TorsionalTrain,
    TwoMassDrive,
    WoundFlywheel,
    governed_scene,
)
from sweeps.pictures.elements.body_sheets import (
    rotating_guide_sheet,
    tethered_body_sheet,
    tilted_body_sheet,
    wound_flywheel_sheet,
)
from sweeps.pictures.elements.cam_sheet import cam_sheet
from sweeps.pictures.elements.chain_sheet import chain_sheet
from sweeps.pictures.elements.elastic_sheets import (
    compliance_sheet,
    drive_sheet,
    machine_drive_sheet,
    machine_run_sheet,
    oscillator_sheet,
)
from sweeps.pictures.elements.engine_sheet import engine_sheet, engine_table
from sweeps.pictures.elements.friction_sheet import friction_sheet
from sweeps.pictures.elements.gear_sheet import gear_sheet, gear_table
from sweeps.pictures.elements.governor_sheet import governor_sheet
from sweeps.pictures.elements.journal_and_roller_sheets import journal_sheet, roller_sheet
from sweeps.pictures.elements.train_sheet import numbers_of_machine, train_sheet, train_table
from sweeps.pictures.elements.unbalance_plan import static_plan, unbalance_plan
from sweeps.pictures.elements.vehicle_sheets import car_sheet, locomotive_sheet


def element_pictures(scene: Scene, path: Path) -> list[Path]:
    """Draw the elements of a scene, from rotors and engines to gears and screws.

    Parameters
    ----------
    scene : Scene
    path : Path
        The names of the pictures are this one's with the element's name and `_plan`, `_orders`, `_shaking`, `_braking`,
        `_sliding`, `_views`, `_stresses`, `_pull`, `_governor`, `_vibration`, `_transient`, `_cycle`, `_run`,
        `_shares`, `_cam`, `_velocities`, `_chain` or `_friction` added.

    Returns
    -------
    list of Path
        The files made.

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written; a cam's follower doesn't reach its base circle,
        a machine has no steady motion on its elastic shaft, or a
        body can't be.
    """
    made = []
    scene, cycles = governed_scene(scene)
    for name, element in scene.elements.items():
        title = f"{scene.title}: {name}" if scene.title else name
        match element:
            case RotorElement():
                made.append(path.with_name(f"{path.stem}_{name}_plan{path.suffix}"))
                unbalance_plan(element, made[-1], title)
            case StaticRotor():
                made.append(path.with_name(f"{path.stem}_{name}_plan{path.suffix}"))
                static_plan(element, made[-1], title)
            case EngineElement():
                made.append(path.with_name(f"{path.stem}_{name}_orders{path.suffix}"))
                engine_sheet(element, made[-1], title)
            case LocomotiveElement():
                made.append(path.with_name(f"{path.stem}_{name}_shaking{path.suffix}"))
                locomotive_sheet(element, made[-1], title)
            case CarElement():
                made.append(path.with_name(f"{path.stem}_{name}_braking{path.suffix}"))
                car_sheet(element, made[-1], title)
            case RotatingGuide():
                made.append(path.with_name(f"{path.stem}_{name}_sliding{path.suffix}"))
                rotating_guide_sheet(element, made[-1], title)
            case TiltedBody():
                made.append(path.with_name(f"{path.stem}_{name}_views{path.suffix}"))
                tilted_body_sheet(element, made[-1], title)
            case WoundFlywheel():
                made.append(path.with_name(f"{path.stem}_{name}_stresses{path.suffix}"))
                wound_flywheel_sheet(element, made[-1], title)
            case Governor():
                made.append(path.with_name(f"{path.stem}_{name}_governor{path.suffix}"))
                governor_sheet(element, made[-1], title, cycles.get(name))
            case TorsionalTrain():
                made.append(path.with_name(f"{path.stem}_{name}_vibration{path.suffix}"))
                train_sheet(scene, name, made[-1], title)
            case TetheredBody():
                made.append(path.with_name(f"{path.stem}_{name}_pull{path.suffix}"))
                tethered_body_sheet(element, made[-1], title)
            case ComplianceElement():
                made.append(path.with_name(f"{path.stem}_{name}_shares{path.suffix}"))
                compliance_sheet(element, made[-1], title)
            case ChainDrive():
                made.append(path.with_name(f"{path.stem}_{name}_chain{path.suffix}"))
                chain_sheet(element, made[-1], title)
            case OscillatorElement():
                made.append(path.with_name(f"{path.stem}_{name}_vibration{path.suffix}"))
                oscillator_sheet(element, made[-1], title)
            case TwoMassDrive():
                made.append(path.with_name(f"{path.stem}_{name}_transient{path.suffix}"))
                drive_sheet(element, made[-1], title)
            case MachineDrive():
                made.append(path.with_name(f"{path.stem}_{name}_cycle{path.suffix}"))
                machine_drive_sheet(scene, name, made[-1], title)
                if element.run is not None:
                    made.append(path.with_name(f"{path.stem}_{name}_run{path.suffix}"))
                    machine_run_sheet(scene, name, made[-1], title)
            case CamElement():
                made.append(path.with_name(f"{path.stem}_{name}_cam{path.suffix}"))
                cam_sheet(element, made[-1], title)
            case GearTrain():
                made.append(path.with_name(f"{path.stem}_{name}_velocities{path.suffix}"))
                gear_sheet(element, made[-1], title)
            case _ if element.type == "journal":
                made.append(path.with_name(f"{path.stem}_{name}_friction{path.suffix}"))
                journal_sheet(element, made[-1], title)
            case _ if element.type == "roller":
                made.append(path.with_name(f"{path.stem}_{name}_friction{path.suffix}"))
                roller_sheet(element, made[-1], title)
            case _:
                made.append(path.with_name(f"{path.stem}_{name}_friction{path.suffix}"))
                friction_sheet(element, made[-1], title)
    return made


def element_tables(scene: Scene) -> str:
    """Tables of engines' orders, of torsional trains' modes and of gear trains' shafts, in words; "" without any."""
    told = []
    for name, element in scene.elements.items():
        match element:
            case EngineElement():
                told.append(f"{name}: orders of the crank\n{engine_table(element)}")
            case TorsionalTrain():
                rows = train_table(element, numbers_of_machine(scene, name))
                told.append(f"{name}: Holzer's table, reduced to {element.layout.masses[0]}\n{rows}")
            case GearTrain():
                told.append(f"{name}: {gear_table(element)}")
    return "\n".join(told)
