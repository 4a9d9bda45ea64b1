#include "manifest/reference.h"

#include "manifest/model.h"
#include "manifest/section_tables.h"

namespace gonio::manifest {
namespace {

// A cell of a table, in which a bar would begin the next one.
std::string in_cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

template <class Record>
std::string rows(const std::string& heading, const std::string& what, const std::vector<Field<Record>>& fields) {
  std::string out = "## " + heading + "\n" + what + "\n\n| key | unit | meaning |\n| --- | --- | --- |\n";
  for (const auto& f : fields)
    out += "| " + f.name + (f.required ? " (needed)" : "") + " | " + f.unit + " | " + in_cell(f.sentence) + " |\n";
  return out + "\n";
}

std::string model_rows(const std::string& heading, const std::string& what, Family family) {
  std::string out = "## " + heading + "\n" + what + "\n\n";
  for (const ModelInfo* model : models(family)) {
    out += "**" + model->id + "**: " + model->sentence + (model->source.empty() ? "" : " (" + model->source + ")") +
           "\n\n";
    out += "| key | unit | meaning |\n| --- | --- | --- |\n";
    for (const auto& p : model->parameters)
      out += "| " + p.name + (p.preset ? "" : " (needed)") + " | " + (p.unit == "1" ? "" : p.unit) + " | " +
             in_cell(p.meaning) + " |\n";
    out += "\n";
  }
  return out;
}

template <class T>
Value keyed() {
  return Codec<std::map<std::string, T>>::schema();
}
template <class T>
Value listed() {
  return Codec<std::vector<T>>::schema();
}

std::string goniometry_text() {
  return rows("goniometer", "Keyed by name. Flat samples that goniometer images show, and white tiles beside them.",
              flat_patch_fields()) +
         rows("surface_fits",
              "Keyed by the name of the surface, written by brdf-fit. How it was told from measured reflectances.",
              surface_fit_fields()) +
         rows("surface_fits: alternatives", "Models that were fitted and not chosen.", alternative_fit_fields()) +
         rows("surface_fits: dropped", "Rows that were left out.", dropped_rows_fields()) +
         rows("patterns", "Keyed by name. Flat samples whose cells form a binary pattern.", pattern_fields()) +
         rows("patterns: placements", "How the sample lay before the camera.", pattern_placement_fields()) +
         rows("patterns: defects", "Cells that behave unlike their class, written by contrast.",
              pattern_defect_fields()) +
         rows("contrasts", "A list, written by contrast.", contrast_fields());
}

std::string nrsfm_text() {
  return rows("sequences", "Keyed by name. Points of shapes that deform, followed over frames.",
              track_sequence_fields()) +
         rows("reconstructions", "A list. Shapes that a solver made of a sequence.", shape_reconstruction_fields()) +
         rows("evaluations", "A list, written by nrsfm-eval. Reconstructions against the truth.", evaluation_fields()) +
         rows("evaluations: errors", "One for each measure and alignment.", evaluated_error_fields()) +
         rows("evaluations: flips", "Frames that are mirrored although most are not.", detected_flip_fields());
}

std::string relief_text() {
  return rows("reliefs",
              "Keyed by name. Height maps, measured or made by relief, with what roughness and lobe say of them. "
              "Azimuths "
              "count counter-clockwise from the direction of the rows.",
              relief_map_fields()) +
         rows("reliefs: treatment", "What was taken off the heights before.", relief_treatment_fields()) +
         rows("reliefs: parameters", "Keyed by name, written by roughness.", roughness_figure_fields()) +
         rows("reliefs: normals", "Written by roughness. Distributions of microfacet theory.", normals_fit_fields()) +
         rows("reliefs: lobes", "Written by lobe.", relief_lobe_fields()) +
         rows("ground_noises", "Keyed by name, written by relief. What a process adds to all that it makes.",
              ground_noise_fields()) +
         rows("ground_noises: parts", "Sparse convolution noises.", ground_noise_part_fields());
}

}  // namespace

Value manifest_schema() {
  Value properties = Value::object(
      {{"gonio", Value::object({{"const", 1}})},
       {"files", keyed<File>()},
       {"frames", listed<Link>()},
       {"boards", keyed<Board>()},
       {"cameras", keyed<Camera>()},
       {"rigs", keyed<Rig>()},
       {"robots", keyed<Robot>()},
       {"images", listed<ImageEntry>()},
       {"meshes", keyed<Mesh>()},
       {"surfaces", keyed<Surface>()},
       {"lights", keyed<Light>()},
       {"objects", listed<Object>()},
       {"tables", keyed<Table>()},
       {"mechanisms", keyed<MechanismUse>()},
       {"renderings", listed<Rendering>()},
       {"comparisons", listed<Comparison>()},
       {"mountings", keyed<Mounting>()},
       {"light_positions", listed<LightPosition>()},
       {"acceptance", listed<AcceptanceResult>()},
       {"goniometer", keyed<FlatPatch>()},
       {"surface_fits", keyed<SurfaceFit>()},
       {"patterns", keyed<Pattern>()},
       {"contrasts", listed<Contrast>()},
       {"reliefs", keyed<ReliefMap>()},
       {"ground_noises", keyed<GroundNoiseFit>()},
       {"sequences", keyed<TrackSequence>()},
       {"reconstructions", listed<ShapeReconstruction>()},
       {"evaluations", listed<Evaluation>()},
       {"explanations", Value::object({{"type", "array"}, {"items", Value::object({{"type", "object"}})}})},
       {"provenance", Value::object({{"type", "object"}})}});
  return Value::object({{"$schema", "http://json-schema.org/draft-07/schema#"},
                        {"title", "gonio manifest, version 1"},
                        {"type", "object"},
                        {"required", Value(Value::Array{"gonio"})},
                        {"properties", std::move(properties)},
                        {"patternProperties", Value::object({{"^x-", Value::object()}})},
                        {"additionalProperties", false}});
}

std::string manifest_fields_text() {
  return rows("files", "Keyed by id. Pixels, meshes and tables beside the document.", file_fields()) +
         rows("frames", "A list. Rigid motions between named frames: p_to = rotation * p_from + translation.",
              link_fields()) +
         rows("boards", "Keyed by name. Calibration targets.", board_fields()) +
         rows("cameras", "Keyed by name. How rays map to pixels.", camera_fields()) +
         rows("cameras: quality", "How well a calibration predicts, an object in a camera.", camera_quality_fields()) +
         rows("rigs", "Keyed by name. Cameras held together.", rig_fields()) +
         rows("rigs: cameras", "The members of a rig.", rig_member_fields()) +
         rows("robots", "Keyed by name. Arms that hold cameras, boards or lights.", robot_fields()) +
         rows("robots: dh", "Rows of a Denavit-Hartenberg table.", dh_row_fields()) +
         rows("images", "A list. Recordings, or pictures to be simulated.", image_fields()) +
         rows("images: boards", "Boards in an image that shows several.", seen_board_fields()) +
         rows("meshes", "Keyed by name. Exactly one of file, sphere, plane.", mesh_fields()) +
         model_rows("surfaces",
                    "Keyed by name. `model` and its parameters; `textures` maps a parameter to a file id; `sigma` "
                    "holds uncertainties.",
                    Family::surface) +
         model_rows("lights", "Keyed by name. `model` and its parameters.", Family::light) +
         rows("objects", "A list. A mesh with a surface at a place.", object_fields()) +
         rows("tables", "Keyed by name. One row per observation.", table_fields()) +
         rows("renderings", "A list, written by render.", rendering_fields()) +
         rows("comparisons", "A list, written by compare.", comparison_fields()) +
         rows("mountings", "Keyed by name, written by handeye. What is fixed to a robot's tool or stands in its world.",
              mounting_fields()) +
         rows("mountings: held_out", "Errors on poses that the fit did not see.", held_out_fields()) +
         rows("mountings: parts", "Standard deviations of the board's position.", scatter_parts_fields()) +
         rows("light_positions", "A list. Where a light was while its robot stood at a pose.",
              light_position_fields()) +
         rows("acceptance", "A list, written by vdi2634. Figures of an optical scanner.", acceptance_fields()) +
         goniometry_text() + relief_text() + nrsfm_text();
}

}  // namespace gonio::manifest
