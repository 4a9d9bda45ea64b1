// One list of what the manifest is made of yields the schema and the manual.
#include "manifest/reference.h"

#include "manifest/explanation_tables.h"
#include "manifest/finite_makers.h"
#include "manifest/model.h"
#include "manifest/section_tables.h"

namespace gonio::manifest {
namespace {

// A section, or a part of sections: how it stands in the schema, and what the manual says of it.
struct Described {
  std::string name;  // of the definition; empty: the schema needs none
  Value definition;
  std::string text;        // Markdown
  std::string section{};   // of the document; empty: this is a part
  Value section_schema{};  // of that section
};

template <class Record>
std::string table_of(const std::vector<Field<Record>>& fields) {
  std::string out = "| key | unit | meaning |\n| --- | --- | --- |\n";
  for (const auto& f : fields)
    out += "| " + f.name + (f.required ? " (needed)" : "") + " | " + f.unit + " | " + in_cell(f.sentence) + " |\n";
  return out + "\n";
}

template <class Record>
Described part(const std::string& heading, const std::string& what, const std::vector<Field<Record>>& fields) {
  return {.name = definition_name(Codec<Record>::schema()),
          .definition = record_schema(fields),
          .text = "## " + heading + "\n" + what + "\n\n" + table_of(fields)};
}

template <class Record>
Described keyed(const std::string& name, const std::string& what, const std::vector<Field<Record>>& fields) {
  Described d = part(name, "Keyed by name. " + what, fields);
  d.section = name;
  d.section_schema = Codec<std::map<std::string, Record>>::schema();
  return d;
}

template <class Record>
Described listed(const std::string& name, const std::string& what, const std::vector<Field<Record>>& fields) {
  Described d =
      part(name, "A list" + std::string(what.starts_with("Written") ? ", w" + what.substr(1) : ". " + what), fields);
  d.section = name;
  d.section_schema = Codec<std::vector<Record>>::schema();
  return d;
}

std::string parameters_of(const ModelInfo& model) {
  if (model.parameters.empty()) return "";
  std::string out = "| key | unit | numbers | default | bounds | meaning |\n| --- | --- | --- | --- | --- | --- |\n";
  for (const ParameterInfo& p : model.parameters)
    out += "| " + p.name + " | " + (p.unit == "1" ? "" : p.unit) + " | " + (p.rgb ? "1 or " : "") +
           std::to_string(p.components) + " | " + (p.preset ? shown_number(*p.preset) : "needed") + " | " +
           bounds_text(p.lower, p.upper) + " | " + in_cell(p.meaning) + " |\n";
  return out + "\n";
}

std::string models_text(Family family, const std::string& level) {
  std::string out;
  for (const ModelInfo* model : models(family)) {
    out += level + model->id + "\n" + model->sentence + (model->source.empty() ? "" : " (" + model->source + ")");
    if (model->attachment != Attachment::none) out += " Its `file`: " + model->attachment_meaning + ".";
    if (model->takes_base) out += " Lies on another surface, its `base`.";
    out += "\n\n" + parameters_of(*model);
  }
  return out;
}

using List = std::vector<Described>;

void add_scene(List& all) {
  all.push_back(keyed("files", "Pixels, meshes and tables beside the document.", file_fields()));
  all.push_back(
      listed("frames", "Rigid motions between named frames: p_to = rotation * p_from + translation.", link_fields()));
  all.push_back(keyed("boards", "Calibration targets.", board_fields()));
  all.push_back(keyed("cameras", "How rays map to pixels.", camera_fields()));
  all.push_back(
      part("cameras: quality", "How well a calibration predicts, an object in a camera.", camera_quality_fields()));
  all.push_back(keyed("rigs", "Cameras held together.", rig_fields()));
  all.push_back(part("rigs: cameras", "The members of a rig.", rig_member_fields()));
  all.push_back(keyed("robots", "Arms that hold cameras, boards or lights.", robot_fields()));
  all.push_back(part("robots: dh", "Rows of a Denavit-Hartenberg table.", dh_row_fields()));
  all.push_back(listed("images", "Recordings, or pictures to be simulated.", image_fields()));
  all.push_back(part("images: boards", "Boards in an image that shows several.", seen_board_fields()));
  all.push_back(
      part("images: developed", "Steps from the sensor's numbers to the picture, in order.", developed_step_fields()));
  all.push_back(keyed("colour",
                      "Written by color-calib. How a camera's linear numbers become colours; develop applies it.",
                      colour_correction_fields()));
  all.push_back(part("colour: patches", "Patches of the chart.", colour_patch_fields()));
  all.push_back(part("colour: alternatives", "Models that were tried.", colour_alternative_fields()));
  all.push_back(keyed("meshes", "Exactly one of file, sphere, plane.", mesh_fields()));
  all.push_back(keyed("surfaces", "A model, its parameters under their own names (gonio-surfaces(7) has both), and:",
                      surface_fields()));
  all.back().definition = surface_definition();
  all.push_back({.name = definition_name(Codec<LawUse>::schema()), .definition = law_definition(), .text = ""});
  all.push_back(keyed("environments",
                      "Pictures of all directions about a place, written by light-probe; a light refers to one.",
                      environment_fields()));
  all.push_back(keyed("lights", "A model, its parameters under their own names, and:", light_fields()));
  all.back().definition = light_definition();
  all.back().text += models_text(Family::light, "## lights: ");
  all.push_back(listed("objects", "A mesh with a surface at a place.", object_fields()));
  all.push_back(keyed("tables", "One row per observation.", table_fields()));
  all.push_back(
      {.name = definition_name(Codec<MechanismUse>::schema()),
       .definition = mechanism_use_definition(),
       .text = "## mechanisms\nKeyed by id, of gonio-mechanisms(7). Optional physics that is switched on: its "
               "parameters under their own names, each one number or one for each name in `on` (or lists of one "
               "length, of mechanisms that say so), and:\n\n" +
               table_of(mechanism_use_fields()),
       .section = "mechanisms",
       .section_schema = {}});
}

void add_results(List& all) {
  all.push_back(
      keyed("projections", "Written by structured-light: what a projector shows in turn.", projection_fields()));
  all.push_back(
      part("projections: frames", "Pictures, in the order in which they are shown.", projected_frame_fields()));
  all.push_back(keyed("clouds", "Written by structured-light: points that were measured.", cloud_fields()));
  all.push_back(part("clouds: shape", "What is known of the thing that was measured.", known_shape_fields()));
  Described registration =
      part("registration", "Written by cloud-register: whether views agree, and how they were moved.",
           registration_fields());
  registration.section = "registration";
  registration.section_schema = Codec<Registration>::schema();
  all.push_back(std::move(registration));
  all.push_back(part("registration: pairs", "Two views whose surfaces overlap.", registered_pair_fields()));
  all.push_back(part("registration: views", "Left out where nothing was to be moved.", registered_view_fields()));
  all.push_back(listed("outlines", "Rims of objects and shadows in photographs; masks by users, points by align.",
                       outline_fields()));
  all.push_back(
      listed("alignments", "Written by align: where objects, lamps and cameras are, by rims.", alignment_fields()));
  all.push_back(part("alignments: lights", "Lamps that shadows place.", aligned_light_fields()));
  all.push_back(part("alignments: cameras", "Cameras that moved along.", aligned_camera_fields()));
  all.push_back(part("alignments: pictures", "The last step, by the pictures themselves.", aligned_pictures_fields()));
  all.push_back(part("alignments: candidates", "Poses that fit as well.", alignment_candidate_fields()));
  all.push_back(listed("renderings", "Written by render.", rendering_fields()));
  all.push_back(listed("comparisons", "Written by compare.", comparison_fields()));
  all.push_back(keyed("mountings", "Written by handeye. What is fixed to a robot's tool or stands in its world.",
                      mounting_fields()));
  all.push_back(part("mountings: held_out", "Errors on poses that the fit did not see.", held_out_fields()));
  all.push_back(part("mountings: parts", "Standard deviations of the board's position.", scatter_parts_fields()));
  all.push_back(
      listed("light_positions", "Where a light was while its robot stood at a pose.", light_position_fields()));
  all.push_back(listed("acceptance", "Written by vdi2634. Figures of an optical scanner.", acceptance_fields()));
}

void add_goniometry(List& all) {
  all.push_back(keyed("goniometer", "Flat samples that goniometer images show, and white tiles beside them.",
                      flat_patch_fields()));
  all.push_back(keyed("surface_fits",
                      "The name is the surface's. Written by brdf-fit: how it was told from measured reflectances.",
                      surface_fit_fields()));
  all.push_back(
      part("surface_fits: alternatives", "Models that were fitted and not chosen.", alternative_fit_fields()));
  all.push_back(part("surface_fits: dropped", "Rows that were left out.", dropped_rows_fields()));
  all.push_back(keyed("patterns", "Flat samples whose cells form a binary pattern.", pattern_fields()));
  all.push_back(part("patterns: placements", "How the sample lay before the camera.", pattern_placement_fields()));
  all.push_back(
      part("patterns: defects", "Cells that behave unlike their class, written by contrast.", pattern_defect_fields()));
  all.push_back(listed("contrasts", "Written by contrast.", contrast_fields()));
}

void add_reliefs(List& all) {
  all.push_back(
      keyed("reliefs",
            "Height maps, measured or made by relief, with what roughness and lobe say of them. Azimuths count "
            "counter-clockwise from the direction of the rows.",
            relief_map_fields()));
  all.push_back(part("reliefs: treatment", "What was taken off the heights before.", relief_treatment_fields()));
  all.push_back(part("reliefs: parameters", "Keyed by name, written by roughness.", roughness_figure_fields()));
  all.push_back(
      part("reliefs: normals", "Written by roughness. Distributions of microfacet theory.", normals_fit_fields()));
  all.push_back(part("reliefs: lobes", "Written by lobe.", relief_lobe_fields()));
  all.push_back(
      keyed("ground_noises", "Written by relief. What a process adds to all that it makes.", ground_noise_fields()));
  all.push_back(part("ground_noises: parts", "Sparse convolution noises.", ground_noise_part_fields()));
}

void add_prints(List& all) {
  all.push_back(
      keyed("prints",
            "A printer that cures layers by light, and what dlp-slice sends to it. Frame: x along the rows of "
            "the projector's pixels, y along its columns, z away from the platform, the origin at the "
            "picture's centre.",
            print_fields()));
  all.push_back(part("prints: growth", "Height h of a voxel by its grey value I: alpha_m + beta_m log(I - gamma).",
                     print_growth_fields()));
  all.push_back(part("prints: bleed", "How light spreads about a pixel.", print_bleed_fields()));
  all.push_back(part("prints: parts", "Meshes on the platform.", printed_part_fields()));
  all.push_back(part("prints: measured", "Maps of what was printed, seen from the projector.", measured_print_fields()));
  all.push_back(part("prints: microstructures",
                     "Patterns of surfaces, as a share of the topmost layer: a model, its parameters under their own "
                     "names, and:",
                     microstructure_use_fields()));
  all.back().definition = microstructure_definition();
  all.back().text += models_text(Family::microstructure, "### ");
}

void add_volumes(List& all) {
  all.push_back(keyed("volumes",
                      "Samples on a grid, as tomographs give them, and the surface that ct-mesh-clean made of them. "
                      "Index (0, 0, 0) is the centre of the first voxel.",
                      volume_fields()));
  all.push_back(
      part("volumes: volume_from_index", "Columns are the grid's axes times the spacing.", index_map_fields()));
  all.push_back(part("volumes: steps", "Written by ct-mesh-clean.", volume_step_fields()));
  all.push_back(listed("markers", "Spheres glued to an object, found by ct-mesh-clean.", marker_fields()));
  all.push_back(
      listed("placements", "Where pieces that were scanned elsewhere stand, found by reassemble.", placement_fields()));
  all.push_back(
      part("placements: pairs", "A marker of the piece, and what the photographs show of it.", marker_pair_fields()));
  all.push_back(part("placements: contacts", "What the piece touches.", placement_contact_fields()));
}

void add_acquisition(List& all) {
  Described laboratory = part("laboratory", "The instrument as its owner believes it to be.", laboratory_fields());
  laboratory.section = "laboratory";
  laboratory.section_schema = Codec<Laboratory>::schema();
  all.push_back(std::move(laboratory));
  const std::string l = "laboratory: ";
  all.push_back(part(l + "robots", "Keyed by name.", laboratory_robot_fields()));
  all.push_back(part(l + "robots/limits", "One number a joint.", joint_limits_fields()));
  all.push_back(part(l + "robots/cable", "One number a joint.", cable_slack_fields()));
  all.push_back(part(l + "obstacles, robots/carries, robots/links",
                     "Solids that nothing may touch; exactly one of box_m, ball_m, cylinder_m, mesh.",
                     solid_body_fields()));
  all.push_back(part(l + "cameras", "Keyed by name.", laboratory_camera_fields()));
  all.push_back(part(l + "lamps", "Keyed by name.", laboratory_lamp_fields()));
  all.push_back(part(l + "turntables", "Keyed by name.", laboratory_turntable_fields()));
  all.push_back(part(l + "screens", "Keyed by name.", laboratory_screen_fields()));
  all.push_back(part(l + "limits", "Enforced before a command is sent.", laboratory_limits_fields()));
  all.push_back(listed("plans", "Written by acquire: what to photograph, by which motions.", plan_fields()));
  all.push_back(part("plans: steps", "One photograph, or one bracket of them.", plan_step_fields()));
  all.push_back(part("plans: unreachable", "Views that no arm reaches.", unreachable_view_fields()));
  all.push_back(part("plans: measured", "Where cameras were found at the steps, by its runs.", measured_view_fields()));
  all.push_back(
      part("plans: checks", "Corners of a board as the first run of the plan found them.", check_view_fields()));
  all.push_back(listed("runs", "Written by acquire: what was done of plans.", run_fields()));
  all.push_back(part("runs: repeatability",
                     "Of the board's place before the camera, over takes of the same views, beyond the corners' "
                     "noise.",
                     repeatability_fields()));
  all.push_back(part("runs: drifted",
                     "Frames between a view of the board that had moved by more than the limit and the checks before "
                     "and after it. Nobody knows from where they were taken: their poses are not remembered.",
                     drifted_frames_fields()));
}

void add_tracks(List& all) {
  all.push_back(keyed("sequences", "Points of shapes that deform, followed over frames.", track_sequence_fields()));
  all.push_back(listed("reconstructions", "Shapes that a solver made of a sequence.", shape_reconstruction_fields()));
  all.push_back(
      listed("evaluations", "Written by nrsfm-eval. Reconstructions against the truth.", evaluation_fields()));
  all.push_back(part("evaluations: errors", "One for each measure and alignment.", evaluated_error_fields()));
  all.push_back(part("evaluations: flips", "Frames that are mirrored although most are not.", detected_flip_fields()));
}

void add_explanations(List& all) {
  const std::string e = "explanations: ";
  all.push_back(
      listed("explanations",
             "Written by explain, an entry for each domain that it found. A number that is not finite is null.",
             explanation_fields()));
  all.push_back(part(e + "misplaced", "Files that fit another recording.", misplaced_file_fields()));
  all.push_back(part(e + "named", "What was left out.", named_mechanism_fields()));
  all.push_back(
      part(e + "outside", "A law of no known effect, or only where the structure is.", outside_library_fields()));
  all.push_back(part(e + "outside/terms", "coefficient * product of condition^power * shape.", law_term_fields()));
  all.push_back(part(e + "outside/terms/shape", "A function of a condition.", term_shape_fields()));
  all.push_back(part(e + "located", "The most telling condition and what else is known of the place.",
                     located_mismatch_fields()));
  all.push_back(part(e + "located/conditions", "All conditions that carry it.", mismatch_condition_fields()));
  all.push_back(part(e + "located/groups", "What each group holds of it.", mismatch_group_fields()));
  all.push_back(part(e + "located/boxes", "Parts of pictures.", mismatch_box_fields()));
  all.push_back(part(e + "held_out", "The proof.", held_out_score_fields()));
  all.push_back(part(e + "fitted", "Also of outside.", before_after_fields()));
  all.push_back(part(e + "null_test", "Is there a mismatch?", null_test_fields()));
  all.push_back(
      part(e + "contradicted", "Names that do not stand before what others recorded.", contradicted_name_fields()));
  all.push_back(part(e + "stability", "The same question of parts of the recordings.", answer_stability_fields()));
  all.push_back(part(e + "stability/answers", "One answer, and how often.", answer_of_parts_fields()));
  all.push_back(part(e + "noise", "Against what was stated.", explained_noise_fields()));
  all.push_back(part(e + "negative_controls", "Mechanisms without physics.", negative_controls_fields()));
  all.push_back(part(e + "scoreboard", "One for each hypothesis.", scored_hypothesis_fields()));
  all.push_back(part(e + "weighed", "One for each answer that was held against the others.", weighed_answer_fields()));
  all.push_back(part(e + "isolability", "One for each mechanism that applies.", mechanism_visibility_fields()));
  all.push_back(part(e + "isolability/looks_like", "Mechanisms that are hard to tell apart.", look_alike_fields()));
  all.push_back(part(e + "compensation", "One for each free parameter.", shifted_parameter_fields()));
  all.push_back(part(e + "compensation/calibrated", "Its value from elsewhere.", independent_value_fields()));
  all.push_back(part(e + "next_measurement", "A proposal.", next_measurement_fields()));
  all.push_back(part(e + "next_measurement/plan", "One for each measurement.", planned_measurement_fields()));
  all.push_back(part(e + "next_measurement/plan/setup/images", "Views to take.", planned_view_fields()));
}

void add_shared(List& all) {
  all.push_back(
      {.name = definition_name(Codec<Parameter>::schema()),
       .definition = parameter_definition(),
       .text = "## any parameter\nOne number, a list of numbers, or an object:\n\n" + table_of(parameter_fields())});
  all.push_back(part("any rigid motion", "What is called a_from_b takes b to a coordinates.", rigid_motion_fields()));
  all.push_back(part("any rigid motion: sigma", "Beside it.", pose_sigma_fields()));
  all.push_back(part("any noise", "Of a camera's pixels.", noise_fields()));
  const auto shapes = [&all](const char* name, Value schema) { all.push_back({name, std::move(schema), ""}); };
  const Value text = Codec<std::string>::schema(), number = Value::object({{"type", "number"}, {"minimum", 0}});
  const auto either = [](Value one, Value list) {
    return Value::object({{"oneOf", Value(Value::Array{std::move(one), std::move(list)})}});
  };
  shapes("names", either(text, Codec<std::vector<std::string>>::schema()));
  shapes("texts", by_name(text));
  shapes("sigmas", by_name(either(number, Value::object({{"type", "array"}, {"items", number}}))));
  shapes("labels", by_name(Codec<Parameters>::schema()));
  shapes("lists", by_name(Codec<std::vector<double>>::schema()));
  shapes("axes", axes_definition());
  shapes("one-or-more", one_or_more_definition());
  shapes("numbers-by-name", named_numbers_definition());
}

List all_described() {
  List all;
  add_scene(all);
  add_results(all);
  add_goniometry(all);
  add_reliefs(all);
  add_prints(all);
  add_volumes(all);
  add_acquisition(all);
  add_tracks(all);
  add_explanations(all);
  Described provenance = part("provenance", "Written by the programs alone: which of them made the document, of what.",
                              provenance_fields());
  provenance.section = "provenance";
  provenance.section_schema = Codec<Provenance>::schema();
  all.push_back(std::move(provenance));
  all.push_back(part("provenance: steps", "Keyed by a hash of its content.", provenance_step_fields()));
  all.push_back(part("provenance: runs", "Keyed by the step.", provenance_run_fields()));
  add_shared(all);
  return all;
}

}  // namespace

std::string in_cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

Value manifest_schema(const Value& mechanisms) {
  Value properties = Value::object({{"gonio", Value::object({{"const", 1}})}}), definitions = Value::object();
  for (Described& d : all_described()) {
    if (!d.section.empty())
      properties[d.section] = d.section == "mechanisms" ? mechanisms : std::move(d.section_schema);
    if (!d.name.empty()) definitions[d.name] = std::move(d.definition);
  }
  Value schema =
      Value::object({{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "gonio manifest, version 1"}});
  Value document = object_schema(std::move(properties), {"gonio"});
  for (auto& [key, member] : document.as_object()) schema[key] = std::move(member);
  schema["$defs"] = std::move(definitions);
  return schema;
}

std::string manifest_fields_text() {
  std::string text;
  for (const Described& d : all_described()) text += d.text;
  return text;
}

std::string surface_models_text() {
  return "# MODELS\n" + models_text(Family::surface, "## ") +
         "# LAWS\nWhat a parameter may follow under `laws`: `{\"law\": NAME, ...}` with\n\n" +
         models_text(Family::law, "## ");
}

}  // namespace gonio::manifest
