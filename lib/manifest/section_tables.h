// The field tables of the manifest's sections, and the codecs that follow from them. Defined in sections.cpp,
// modelled.cpp, instrument_tables.cpp, goniometry_tables.cpp, contrast_tables.cpp and nrsfm_tables.cpp.
#pragma once
#include <vector>

#include "manifest/fields.h"
#include "manifest/sections.h"

namespace gonio::manifest {

const std::vector<Field<File>>& file_fields();
const std::vector<Field<Link>>& link_fields();
const std::vector<Field<Board>>& board_fields();
const std::vector<Field<Camera>>& camera_fields();
const std::vector<Field<ImageEntry>>& image_fields();
const std::vector<Field<Mesh>>& mesh_fields();
const std::vector<Field<Object>>& object_fields();
const std::vector<Field<Table>>& table_fields();
const std::vector<Field<Rendering>>& rendering_fields();
const std::vector<Field<Comparison>>& comparison_fields();
const std::vector<Field<SeenBoard>>& seen_board_fields();
const std::vector<Field<CameraQuality>>& camera_quality_fields();
const std::vector<Field<RigMember>>& rig_member_fields();
const std::vector<Field<Rig>>& rig_fields();
const std::vector<Field<DhRow>>& dh_row_fields();
const std::vector<Field<Robot>>& robot_fields();
const std::vector<Field<HeldOut>>& held_out_fields();
const std::vector<Field<ScatterParts>>& scatter_parts_fields();
const std::vector<Field<Mounting>>& mounting_fields();
const std::vector<Field<LightPosition>>& light_position_fields();
const std::vector<Field<AcceptanceResult>>& acceptance_fields();
const std::vector<Field<FlatPatch>>& flat_patch_fields();
const std::vector<Field<AlternativeFit>>& alternative_fit_fields();
const std::vector<Field<DroppedRows>>& dropped_rows_fields();
const std::vector<Field<SurfaceFit>>& surface_fit_fields();
const std::vector<Field<PatternPlacement>>& pattern_placement_fields();
const std::vector<Field<PatternDefect>>& pattern_defect_fields();
const std::vector<Field<Pattern>>& pattern_fields();
const std::vector<Field<Contrast>>& contrast_fields();
const std::vector<Field<ReliefTreatment>>& relief_treatment_fields();
const std::vector<Field<RoughnessFigure>>& roughness_figure_fields();
const std::vector<Field<NormalsFit>>& normals_fit_fields();
const std::vector<Field<ReliefLobe>>& relief_lobe_fields();
const std::vector<Field<ReliefMap>>& relief_map_fields();
const std::vector<Field<GroundNoisePart>>& ground_noise_part_fields();
const std::vector<Field<GroundNoiseFit>>& ground_noise_fields();
const std::vector<Field<TrackSequence>>& track_sequence_fields();
const std::vector<Field<ShapeReconstruction>>& shape_reconstruction_fields();
const std::vector<Field<EvaluatedError>>& evaluated_error_fields();
const std::vector<Field<DetectedFlip>>& detected_flip_fields();
const std::vector<Field<Evaluation>>& evaluation_fields();

#define GONIO_RECORD(TYPE, TABLE)                                                                                 \
  template <>                                                                                                     \
  struct Codec<TYPE> {                                                                                            \
    static TYPE read(const Value& value, const std::string& place) { return read_record(value, TABLE(), place); } \
    static Value write(const TYPE& member) { return write_record(member, TABLE()); }                              \
    static Value schema() { return record_schema(TABLE()); }                                                      \
  }
GONIO_RECORD(File, file_fields);
GONIO_RECORD(Link, link_fields);
GONIO_RECORD(Board, board_fields);
GONIO_RECORD(CameraQuality, camera_quality_fields);
GONIO_RECORD(Camera, camera_fields);
GONIO_RECORD(SeenBoard, seen_board_fields);
GONIO_RECORD(ImageEntry, image_fields);
GONIO_RECORD(Mesh, mesh_fields);
GONIO_RECORD(Object, object_fields);
GONIO_RECORD(Table, table_fields);
GONIO_RECORD(Rendering, rendering_fields);
GONIO_RECORD(Comparison, comparison_fields);
GONIO_RECORD(RigMember, rig_member_fields);
GONIO_RECORD(Rig, rig_fields);
GONIO_RECORD(DhRow, dh_row_fields);
GONIO_RECORD(Robot, robot_fields);
GONIO_RECORD(HeldOut, held_out_fields);
GONIO_RECORD(ScatterParts, scatter_parts_fields);
GONIO_RECORD(Mounting, mounting_fields);
GONIO_RECORD(LightPosition, light_position_fields);
GONIO_RECORD(AcceptanceResult, acceptance_fields);
GONIO_RECORD(FlatPatch, flat_patch_fields);
GONIO_RECORD(AlternativeFit, alternative_fit_fields);
GONIO_RECORD(DroppedRows, dropped_rows_fields);
GONIO_RECORD(SurfaceFit, surface_fit_fields);
GONIO_RECORD(PatternPlacement, pattern_placement_fields);
GONIO_RECORD(PatternDefect, pattern_defect_fields);
GONIO_RECORD(Pattern, pattern_fields);
GONIO_RECORD(Contrast, contrast_fields);
GONIO_RECORD(ReliefTreatment, relief_treatment_fields);
GONIO_RECORD(RoughnessFigure, roughness_figure_fields);
GONIO_RECORD(NormalsFit, normals_fit_fields);
GONIO_RECORD(ReliefLobe, relief_lobe_fields);
GONIO_RECORD(ReliefMap, relief_map_fields);
GONIO_RECORD(GroundNoisePart, ground_noise_part_fields);
GONIO_RECORD(GroundNoiseFit, ground_noise_fields);
GONIO_RECORD(TrackSequence, track_sequence_fields);
GONIO_RECORD(ShapeReconstruction, shape_reconstruction_fields);
GONIO_RECORD(EvaluatedError, evaluated_error_fields);
GONIO_RECORD(DetectedFlip, detected_flip_fields);
GONIO_RECORD(Evaluation, evaluation_fields);
#undef GONIO_RECORD

// Surfaces, lights and mechanisms are read against the registries instead of a table.
#define GONIO_REGISTERED(TYPE)                                      \
  template <>                                                       \
  struct Codec<TYPE> {                                              \
    static TYPE read(const Value& value, const std::string& place); \
    static Value write(const TYPE& member);                         \
    static Value schema();                                          \
  }
GONIO_REGISTERED(LawUse);
GONIO_REGISTERED(Surface);
GONIO_REGISTERED(Light);
GONIO_REGISTERED(MechanismUse);
#undef GONIO_REGISTERED

}  // namespace gonio::manifest
