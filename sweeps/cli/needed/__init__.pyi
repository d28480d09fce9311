"""Names that commands need from other packages, with their modules."""

from sweeps.cli.named_machine import element_named, is_result, machine_of, positions_of, read_at, with_full_joint_names
from sweeps.guide.chapters import GENERATED, chapter_text, chapters_text
from sweeps.guide.website import build_site
from sweeps.imports.foreign_scene import import_scene
from sweeps.optimising.optimum import answering, is_front, is_search, optimum_text
from sweeps.optimising.search_runner import optimise_study
from sweeps.page.page import write_page
from sweeps.page.page_server import PageServer
from sweeps.page.watched_page import WatchedPage
from sweeps.pictures.drawing.mode_pictures import mode_pictures
from sweeps.pictures.elements.cam_drawing import export_cam
from sweeps.pictures.elements.element_motion import element_frames
from sweeps.pictures.elements.element_pictures import element_tables
from sweeps.pictures.elements.order_picture import order_picture
from sweeps.pictures.machine.animation import machine_frames, save_animation
from sweeps.pictures.machine.cycle_sheets import POSITIONS, field_curves
from sweeps.pictures.machine.hodographs import hodographs
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.picture_files import drawing_file, machine_pictures
from sweeps.pictures.plans.files import bearing_pictures, plan_pictures
from sweeps.pictures.style import save, save_beside
from sweeps.pictures.sweep.result_pictures import result_pictures
from sweeps.report.answers.comparison import comparison
from sweeps.report.check_report import between_positions_text, check_text
from sweeps.report.files.data_files import TABLE_ENDINGS, table_data, write_table
from sweeps.report.files.exports import history_table, reading_table, result_table
from sweeps.report.files.result_data import result_data
from sweeps.report.help.editor_schema import schema_texts
from sweeps.report.help.key_help import key_text, tables_text
from sweeps.report.help.quantity_list import quantities_text
from sweeps.report.help.reference_pages import PAGES
from sweeps.report.mode_table import mode_table
from sweeps.report.order_table import engine_rows, order_table, well_known_engines
from sweeps.report.readings import readings_at, readings_text
from sweeps.report.readings_in_time import readings_in_time
from sweeps.report.result_report import (
    answer_text,
    contents_text,
    counts_text,
    meeting_text,
    variant_text,
    variants_text,
)
from sweeps.report.sizing.balance_shaft_table import balance_shaft_text, engines_of
from sweeps.report.sizing.counterweight_table import counterweight_text, counterweights_of
from sweeps.report.sizing.flywheel_table import flywheel_text
from sweeps.report.sizing.trial_runs import trial_runs_text
from sweeps.report.sweep_result import SweepResult
from sweeps.report.variant_warnings import result_warnings
from sweeps.run.cluster.cluster_errors import ClusterError, UnfinishedError
from sweeps.run.cluster.connecting import connected
from sweeps.run.progress import ProgressBar
from sweeps.run.runner import run_study
from sweeps.store import MappedResult, StoreError, damage_text, variants_kept
from sweeps.study.bundled import bundled_studies, find_study, questions
from sweeps.study.search_task import task_of
from sweeps.study.settings import changed_study
from sweeps.study.study_reader import read_study
from sweeps.study.study_text import is_scene
from sweeps.synthesis.dyads import PlanePosition
from sweeps.synthesis.paths import four_bar_along
from sweeps.synthesis.position_links import chosen_links
from sweeps.synthesis.positioned import best_four_bar_through, four_bar_through
from sweeps.synthesis.quick_return import quick_crank_rocker, quick_lever, quick_slider_crank
from sweeps.synthesis.synthesis_error import SynthesisError
from sweeps.synthesis.synthesised_scenes import (
    crank_rocker_text,
    lever_text,
    path_text,
    positions_text,
    slider_crank_text,
)
from sweeps.text.csv_text import named_columns, read_csv
from sweeps.text.edited_text import edited_scene
from sweeps.text.numbers_in_row import numbers_in_row
from sweeps.text.scene_text import write_scene
from sweeps.text.tables import table_by_subject
from sweeps.text.templates import bundled_templates, template_text, templates
from sweeps.text.toml_text import parse_toml, problems_in
from sweeps.text.whole_files import scratch_folder, write_whole_text
