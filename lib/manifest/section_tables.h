// The field tables of the manifest's sections, and the codecs that follow from them. Defined in sections.cpp,
// modelled.cpp and *_tables.cpp, each of which sees the sections that it describes and no other.
#pragma once
#include <vector>

#include "manifest/fields.h"
#include "manifest/sections/forward.h"

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

// Defined beside the tables (GONIO_RECORD in field_makers.h); of surfaces, lights, laws and mechanisms, which are read
// against the registries instead of a table, in modelled.cpp. No section is complete here.
#define GONIO_SECTION_CODEC(TYPE)                                   \
  template <>                                                       \
  struct Codec<TYPE> {                                              \
    static TYPE read(const Value& value, const std::string& place); \
    static Value write(const TYPE& member);                         \
    static Value schema();                                          \
  }
GONIO_SECTION_CODEC(File);
GONIO_SECTION_CODEC(Link);
GONIO_SECTION_CODEC(Board);
GONIO_SECTION_CODEC(CameraQuality);
GONIO_SECTION_CODEC(Camera);
GONIO_SECTION_CODEC(SeenBoard);
GONIO_SECTION_CODEC(ImageEntry);
GONIO_SECTION_CODEC(Mesh);
GONIO_SECTION_CODEC(Object);
GONIO_SECTION_CODEC(Table);
GONIO_SECTION_CODEC(Rendering);
GONIO_SECTION_CODEC(Comparison);
GONIO_SECTION_CODEC(RigMember);
GONIO_SECTION_CODEC(Rig);
GONIO_SECTION_CODEC(DhRow);
GONIO_SECTION_CODEC(Robot);
GONIO_SECTION_CODEC(HeldOut);
GONIO_SECTION_CODEC(ScatterParts);
GONIO_SECTION_CODEC(Mounting);
GONIO_SECTION_CODEC(LightPosition);
GONIO_SECTION_CODEC(AcceptanceResult);
GONIO_SECTION_CODEC(FlatPatch);
GONIO_SECTION_CODEC(AlternativeFit);
GONIO_SECTION_CODEC(DroppedRows);
GONIO_SECTION_CODEC(SurfaceFit);
GONIO_SECTION_CODEC(PatternPlacement);
GONIO_SECTION_CODEC(PatternDefect);
GONIO_SECTION_CODEC(Pattern);
GONIO_SECTION_CODEC(Contrast);
GONIO_SECTION_CODEC(ReliefTreatment);
GONIO_SECTION_CODEC(RoughnessFigure);
GONIO_SECTION_CODEC(NormalsFit);
GONIO_SECTION_CODEC(ReliefLobe);
GONIO_SECTION_CODEC(ReliefMap);
GONIO_SECTION_CODEC(GroundNoisePart);
GONIO_SECTION_CODEC(GroundNoiseFit);
GONIO_SECTION_CODEC(TrackSequence);
GONIO_SECTION_CODEC(ShapeReconstruction);
GONIO_SECTION_CODEC(EvaluatedError);
GONIO_SECTION_CODEC(DetectedFlip);
GONIO_SECTION_CODEC(Evaluation);
GONIO_SECTION_CODEC(LawUse);
GONIO_SECTION_CODEC(Surface);
GONIO_SECTION_CODEC(Light);
GONIO_SECTION_CODEC(MechanismUse);
#undef GONIO_SECTION_CODEC

}  // namespace gonio::manifest
