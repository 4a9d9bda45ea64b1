// The field tables of the manifest's sections, and the codecs that follow from them. Defined in sections.cpp,
// modelled.cpp and *_tables.cpp, each of which sees the sections that it describes and no other.
#pragma once
#include <vector>

#include "geom/dh_row.h"
#include "manifest/fields.h"
#include "manifest/sections/forward.h"

namespace gonio::manifest {

struct AlignedPictures;

using gonio::DhRow;

struct Provenance;  // sections/provenance.h; nobody passes them on
struct ProvenanceRun;
struct ProvenanceStep;
struct DevelopedStep;  // sections/developed.h
struct KnownShape;     // sections/cloud.h
struct MarkerPair;     // sections/placement.h
struct MeasuredPrint;  // sections/print.h
struct PlacementContact;
struct MeasuredView;  // sections/plan.h
struct CheckView;
struct Repeatability;
struct DriftedFrames;

// The codecs are defined beside the tables (GONIO_RECORD in field_makers.h); those of surfaces, lights, laws and
// mechanisms, which have parameters of a registry beside their table, in modelled.cpp. No section is complete here.
GONIO_TABLE(File, file_fields);
GONIO_TABLE(Link, link_fields);
GONIO_TABLE(Board, board_fields);
GONIO_TABLE(Camera, camera_fields);
GONIO_TABLE(ImageEntry, image_fields);
GONIO_TABLE(Mesh, mesh_fields);
GONIO_TABLE(Object, object_fields);
GONIO_TABLE(Table, table_fields);
GONIO_TABLE(Environment, environment_fields);
GONIO_TABLE(ProjectedFrame, projected_frame_fields);
GONIO_TABLE(Projection, projection_fields);
GONIO_TABLE(KnownShape, known_shape_fields);
GONIO_TABLE(Cloud, cloud_fields);
GONIO_TABLE(RegisteredPair, registered_pair_fields);
GONIO_TABLE(RegisteredView, registered_view_fields);
GONIO_TABLE(Registration, registration_fields);
GONIO_TABLE(Outline, outline_fields);
GONIO_TABLE(AlignedLight, aligned_light_fields);
GONIO_TABLE(AlignedCamera, aligned_camera_fields);
GONIO_TABLE(AlignedPictures, aligned_pictures_fields);
GONIO_TABLE(AlignmentCandidate, alignment_candidate_fields);
GONIO_TABLE(Alignment, alignment_fields);
GONIO_TABLE(Rendering, rendering_fields);
GONIO_TABLE(Comparison, comparison_fields);
GONIO_TABLE(SeenBoard, seen_board_fields);
GONIO_TABLE(DevelopedStep, developed_step_fields);
GONIO_TABLE(ColourPatch, colour_patch_fields);
GONIO_TABLE(ColourAlternative, colour_alternative_fields);
GONIO_TABLE(ColourCorrection, colour_correction_fields);
GONIO_TABLE(CameraQuality, camera_quality_fields);
GONIO_TABLE(RigMember, rig_member_fields);
GONIO_TABLE(Rig, rig_fields);
GONIO_TABLE(DhRow, dh_row_fields);
GONIO_TABLE(Robot, robot_fields);
GONIO_TABLE(HeldOut, held_out_fields);
GONIO_TABLE(ScatterParts, scatter_parts_fields);
GONIO_TABLE(Mounting, mounting_fields);
GONIO_TABLE(LightPosition, light_position_fields);
GONIO_TABLE(AcceptanceResult, acceptance_fields);
GONIO_TABLE(FlatPatch, flat_patch_fields);
GONIO_TABLE(AlternativeFit, alternative_fit_fields);
GONIO_TABLE(DroppedRows, dropped_rows_fields);
GONIO_TABLE(SurfaceFit, surface_fit_fields);
GONIO_TABLE(PatternPlacement, pattern_placement_fields);
GONIO_TABLE(PatternDefect, pattern_defect_fields);
GONIO_TABLE(Pattern, pattern_fields);
GONIO_TABLE(Contrast, contrast_fields);
GONIO_TABLE(ReliefTreatment, relief_treatment_fields);
GONIO_TABLE(RoughnessFigure, roughness_figure_fields);
GONIO_TABLE(NormalsFit, normals_fit_fields);
GONIO_TABLE(ReliefLobe, relief_lobe_fields);
GONIO_TABLE(ReliefMap, relief_map_fields);
GONIO_TABLE(GroundNoisePart, ground_noise_part_fields);
GONIO_TABLE(GroundNoiseFit, ground_noise_fields);
GONIO_TABLE(IndexMap, index_map_fields);
GONIO_TABLE(VolumeStep, volume_step_fields);
GONIO_TABLE(Volume, volume_fields);
GONIO_TABLE(Marker, marker_fields);
GONIO_TABLE(MarkerPair, marker_pair_fields);
GONIO_TABLE(PlacementContact, placement_contact_fields);
GONIO_TABLE(Placement, placement_fields);
GONIO_TABLE(SolidBody, solid_body_fields);
GONIO_TABLE(JointLimits, joint_limits_fields);
GONIO_TABLE(CableSlack, cable_slack_fields);
GONIO_TABLE(LaboratoryRobot, laboratory_robot_fields);
GONIO_TABLE(LaboratoryCamera, laboratory_camera_fields);
GONIO_TABLE(LaboratoryLamp, laboratory_lamp_fields);
GONIO_TABLE(LaboratoryTurntable, laboratory_turntable_fields);
GONIO_TABLE(LaboratoryScreen, laboratory_screen_fields);
GONIO_TABLE(LaboratoryLimits, laboratory_limits_fields);
GONIO_TABLE(Laboratory, laboratory_fields);
GONIO_TABLE(PlanStep, plan_step_fields);
GONIO_TABLE(UnreachableView, unreachable_view_fields);
GONIO_TABLE(MeasuredView, measured_view_fields);
GONIO_TABLE(CheckView, check_view_fields);
GONIO_TABLE(Plan, plan_fields);
GONIO_TABLE(Repeatability, repeatability_fields);
GONIO_TABLE(DriftedFrames, drifted_frames_fields);
GONIO_TABLE(Run, run_fields);
GONIO_TABLE(TrackSequence, track_sequence_fields);
GONIO_TABLE(ShapeReconstruction, shape_reconstruction_fields);
GONIO_TABLE(EvaluatedError, evaluated_error_fields);
GONIO_TABLE(DetectedFlip, detected_flip_fields);
GONIO_TABLE(Evaluation, evaluation_fields);
GONIO_TABLE(LawUse, law_use_fields);
GONIO_TABLE(Surface, surface_fields);
GONIO_TABLE(Light, light_fields);
GONIO_TABLE(MechanismUse, mechanism_use_fields);
GONIO_TABLE(PrintGrowth, print_growth_fields);
GONIO_TABLE(PrintBleed, print_bleed_fields);
GONIO_TABLE(MicrostructureUse, microstructure_use_fields);
GONIO_TABLE(PrintedPart, printed_part_fields);
GONIO_TABLE(MeasuredPrint, measured_print_fields);
GONIO_TABLE(Print, print_fields);
GONIO_TABLE(ProvenanceStep, provenance_step_fields);
GONIO_TABLE(ProvenanceRun, provenance_run_fields);
GONIO_TABLE(Provenance, provenance_fields);

// What stands once in the schema without being a record of one table: a number or such a record, one of several models.
Value parameter_definition();
Value axes_definition();  // one number, or three
Value surface_definition();
Value light_definition();
Value law_definition();
Value microstructure_definition();
Value mechanism_use_definition();

// Of what sections share (shared_tables.cpp); their codecs are declared in codec.h.
const std::vector<Field<Parameter>>& parameter_fields();
const std::vector<Field<PoseSigma>>& pose_sigma_fields();
const std::vector<Field<Noise>>& noise_fields();
const std::vector<Field<RigidFields>>& rigid_motion_fields();

}  // namespace gonio::manifest
