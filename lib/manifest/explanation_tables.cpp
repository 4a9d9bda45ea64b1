// Field tables of "explanations": the entry, its scores and hypotheses, and what to measure next.
#include "manifest/explanation_tables.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "manifest/finite_makers.h"

namespace gonio::manifest {
namespace {

// Members of a setup that are no numbers, or need not be (a table may have such a column): what schema and reader hold
// of each.
struct SetupMember {
  std::string_view name;
  bool or_number;
  Value schema;
  void (*read)(const Value& member, const std::string& place);
};

const std::vector<SetupMember>& setup_members() {
  static const auto vector = [](const Value& v, const std::string& at) { Codec<Vec3>::read(v, at); };
  static const std::vector<SetupMember> all{
      {"image", true, Codec<std::string>::schema(),
       [](const Value& v, const std::string& at) { Codec<std::string>::read(v, at); }},
      {"images", true, Codec<std::vector<PlannedView>>::schema(),
       [](const Value& v, const std::string& at) { Codec<std::vector<PlannedView>>::read(v, at); }},
      {"light", true, defined("names"), [](const Value& v, const std::string& at) { read_names(v, at); }},
      {"light_position_m", false, Codec<Vec3>::schema(), vector},
      {"light_towards", false, Codec<Vec3>::schema(), vector},
  };
  return all;
}

// In the manifest's words, or a table's columns and their numbers.
Field<PlannedMeasurement> setup_field() {
  Value words = Value::object();
  for (const SetupMember& m : setup_members())
    words[std::string(m.name)] =
        m.or_number ? Value::object({{"oneOf", Value(Value::Array{m.schema, Codec<double>::schema()})}}) : m.schema;
  Value schema = Value::object({{"type", "object"},
                                {"properties", std::move(words)},
                                {"patternProperties", Value::object({{"^x-", Value::object()}})},
                                {"additionalProperties", Codec<double>::schema()}});
  return custom<PlannedMeasurement>(
      "setup", "",
      "image, light, exposure_s, exposure_scale: that image again with these; light_towards, light_position_m: with a "
      "lamp in that direction, at that place, world; images: views to take; of a table: its columns and their values",
      std::move(schema),
      [](PlannedMeasurement& p, const Value& v, const std::string& place) {
        expect_object(v, place);
        for (const auto& [key, member] : v.as_object()) {
          if (key.starts_with("x-")) continue;
          const std::string at = place + "/" + key;
          const auto known = std::ranges::find(setup_members(), key, &SetupMember::name);
          if (known == setup_members().end() || (known->or_number && member.is_number()))
            Codec<double>::read(member, at);
          else
            known->read(member, at);
        }
        p.setup = v;
      },
      [](const PlannedMeasurement& p) { return p.setup; });
}

}  // namespace

const std::vector<Field<HeldOutScore>>& held_out_score_fields() {
  using T = HeldOutScore;
  static const std::vector<Field<T>> table{
      number_field("before", &T::before, "", "on groups that the fit never saw: the base model"),
      number_field("after", &T::after, "", "the same with what was found"),
      field("unit", &T::unit, "", "of both").always(""),
      field("score", &T::score, "", "what is measured: rms, ...").always(""),
      field("how", &T::how, "", "each group left out in turn, or test groups opened once").always(""),
      field("test_groups", &T::test_groups, "", "the groups that were opened once").always(Value::array())};
  return table;
}

const std::vector<Field<NullTest>>& null_test_fields() {
  using T = NullTest;
  static const std::vector<Field<T>> table{
      number_field("p", &T::p, "", "of residuals as structured as these where nothing is left out").range(0, 1),
      field("significant", &T::significant, "", "true: there is a mismatch beyond noise"),
      field("important", &T::important, "", "true: and it is larger than what matters"),
      number_field("smallest_effect", &T::smallest_effect, "", "the smallest effect worth a name, a share")};
  return table;
}

const std::vector<Field<ExplainedNoise>>& explained_noise_fields() {
  using T = ExplainedNoise;
  static const std::vector<Field<T>> table{
      number_field("factor", &T::factor, "", "found over stated standard deviation").range(0, infinite),
      field("blocks_set_aside", &T::blocks_set_aside, "", "outliers: blocks that fit nothing").range(0, infinite),
      field("outlying_readings", &T::outlying_readings, "", "beyond five noise widths of the base model; 0: too few")
          .range(0, infinite),
      number_field("outlying_effect", &T::outlying_effect, "", "theirs, as what `smallest_effect` is held against"),
      field("groups_set_aside", &T::groups_set_aside, "", "recordings that fit nothing that explains the others")};
  return table;
}

const std::vector<Field<ContradictedName>>& contradicted_name_fields() {
  using T = ContradictedName;
  static const std::vector<Field<T>> table{
      field("mechanism", &T::mechanism, "", "its id").always("").needed(),
      field("by", &T::by, "", "whose recordings speak against it").always(""),
      field("quantity", &T::quantity, "", "of theirs, which a true name makes smaller or leaves alone").always(""),
      number_field("before", &T::before, "", "without the mechanism, root mean square"),
      number_field("after", &T::after, "", "with it"),
      field("unit", &T::unit, "", "of both").always("")};
  return table;
}

const std::vector<Field<AnswerOfParts>>& answer_of_parts_fields() {
  using T = AnswerOfParts;
  static const std::vector<Field<T>> table{
      field("verdict", &T::verdict, "", "as for the whole").one_of({"null", "named", "ambiguous", "unknown"}),
      field("named", &T::named, "", "mechanisms that were named together").always(Value::array()),
      field("times", &T::times, "", "in so many draws").range(0, infinite)};
  return table;
}

const std::vector<Field<AnswerStability>>& answer_stability_fields() {
  using T = AnswerStability;
  static const std::vector<Field<T>> table{
      field("draws", &T::draws, "", "parts that were explained").range(0, infinite),
      field("groups", &T::groups, "", "recordings in each").range(0, infinite),
      field("same", &T::same, "", "draws whose answer is that of the whole").range(0, infinite),
      field("answers", &T::answers, "", "what came out, the most frequent first").always(Value::array())};
  return table;
}

const std::vector<Field<NegativeControls>>& negative_controls_fields() {
  using T = NegativeControls;
  static const std::vector<Field<T>> table{
      field("run", &T::run, "", "mechanisms without physics in the race").range(0, infinite),
      number_field("passed_share", &T::passed_share, "", "of them that would have passed for physics").range(0, 1)};
  return table;
}

const std::vector<Field<ScoredHypothesis>>& scored_hypothesis_fields() {
  using T = ScoredHypothesis;
  static const std::vector<Field<T>> table{
      field("hypothesis", &T::hypothesis, "", "mechanisms switched on together, a negative control, base or unknown")
          .always("")
          .needed(),
      number_field("held_out", &T::held_out, "", "score on groups that the fit never saw, unit of held_out"),
      number_field("gain", &T::gain, "", "fall of the held-out mean square in noise units"),
      number_field("gain_sigma", &T::gain_sigma, "", "standard error of the gain over groups"),
      number_field("effect", &T::effect, "", "what `smallest_effect` is held against"),
      field("p_neutral", &T::p_neutral, "", "of \"all its parameters are neutral\"").range(0, 1),
      field("refused", &T::refused, "", "why it is not named; left out: it can be")};
  return table;
}

const std::vector<Field<WeighedAnswer>>& weighed_answer_fields() {
  using T = WeighedAnswer;
  static const std::vector<Field<T>> table{
      field("answer", &T::answer, "", "mechanisms together, nothing left out, or none of these (outside)")
          .one_of({"mechanisms", "nothing", "outside"})
          .needed(),
      field("mechanisms", &T::mechanisms, "", "their ids"),
      number_field("probability", &T::probability, "", "that it is the answer").range(0, 1),
      numbers_by_name("statistics", &T::statistics, "what the probability was computed from; left out: zero")};
  return table;
}

const std::vector<Field<LookAlike>>& look_alike_fields() {
  using T = LookAlike;
  static const std::vector<Field<T>> table{
      field("mechanism", &T::mechanism, "", "the other").always("").needed(),
      number_field("cosine", &T::cosine, "", "of the angle between what both do here, -1 to 1")};
  return table;
}

const std::vector<Field<MechanismVisibility>>& mechanism_visibility_fields() {
  using T = MechanismVisibility;
  static const std::vector<Field<T>> table{
      field("mechanism", &T::mechanism, "", "its id").always("").needed(),
      field("on", &T::on, "", "surfaces, lights, ... that it would apply to"),
      number_field("surviving_share", &T::surviving_share, "",
                   "of its effect that free parameters cannot take over, 0 to 1"),
      numbers_by_name("detection_limit", &T::detection_limit,
                      "amplitude of each parameter that is seen with 80 % power, the others neutral"),
      numbers_by_name("limit_with_others", &T::limit_with_others, "the same whatever its other parameters do"),
      field("looks_like", &T::looks_like, "", "mechanisms that do nearly the same here").always(Value::array()),
      field("visible", &T::visible, "", "false: these recordings cannot show it")};
  return table;
}

const std::vector<Field<IndependentValue>>& independent_value_fields() {
  using T = IndependentValue;
  static const std::vector<Field<T>> table{
      number_field("value", &T::value, "", "as calibrated apart"),
      field("sigma", &T::sigma, "", "one standard deviation, where it is stated").range(0, infinite)};
  return table;
}

const std::vector<Field<ShiftedParameter>>& shifted_parameter_fields() {
  using T = ShiftedParameter;
  static const std::vector<Field<T>> table{
      field("parameter", &T::parameter, "", "free parameter of the base model").always("").needed(),
      number_field("before", &T::before, "", "fitted with the base model"),
      number_field("after", &T::after, "", "fitted with what was found"),
      number_field("sigma", &T::sigma, "", "one standard deviation of the latter"),
      field("unit", &T::unit, "", "of all three").always(""),
      field("calibrated", &T::calibrated, "", "what an independent calibration in the document says"),
      field("towards", &T::towards, "", "true: it moved towards that")};
  return table;
}

const std::vector<Field<PlannedView>>& planned_view_fields() {
  using T = PlannedView;
  static const std::vector<Field<T>> table{
      field("camera", &T::camera, "", "name of the camera"), field("board", &T::board, "", "name of the board"),
      field("camera_from_board", &T::camera_from_board, "", "takes board to camera coordinates")};
  return table;
}

const std::vector<Field<PlannedMeasurement>>& planned_measurement_fields() {
  using T = PlannedMeasurement;
  static const std::vector<Field<T>> table{
      field("sentence", &T::sentence, "", "what to measure").always(""), setup_field(),
      field("separates", &T::separates, "", "the two mechanisms that it would part").always(Value::array()),
      number_field("z", &T::z, "", "by how many standard errors")};
  return table;
}

const std::vector<Field<NextMeasurement>>& next_measurement_fields() {
  using T = NextMeasurement;
  static const std::vector<Field<T>> table{field("sentence", &T::sentence, "", "what to measure next, and what for"),
                                           field("plan", &T::plan, "", "the most telling first")};
  return table;
}

// The first versions of explain wrote the condition alone as "outside".
Field<ExplanationEntry> outside_field() {
  return custom<ExplanationEntry>(
             "outside", "", "structure that no mechanism repairs; null: there is none; a text: its condition alone",
             Value::object(
                 {{"oneOf", Value(Value::Array{Codec<OutsideLibrary>::schema(), Codec<std::string>::schema()})}}),
             [](ExplanationEntry& e, const Value& v, const std::string& place) {
               if (v.is_string())
                 e.outside.emplace().condition = v.as_string();
               else
                 e.outside = Codec<OutsideLibrary>::read(v, place);
             },
             [](const ExplanationEntry& e) { return Codec<std::optional<OutsideLibrary>>::write(e.outside); })
      .or_null();
}

const std::vector<Field<ExplanationEntry>>& explanation_fields() {
  using T = ExplanationEntry;
  static const std::vector<Field<T>> table{
      field("domain", &T::domain, "",
            "what was explained: boards, images, stacks, nrsfm, robot, heights, or a kind of table"),
      field(
          "verdict", &T::verdict, "",
          "null: nothing is left out that matters; named: one explanation repairs it; ambiguous: several do, equally; "
          "unknown: there is a mismatch and none does")
          .one_of({"null", "named", "ambiguous", "unknown"})
          .needed(),
      field("probability", &T::probability, "",
            "that the verdict is right: that it is this, or one of those listed, or that the library lacks it")
          .range(0, 1),
      field("misplaced", &T::misplaced, "", "files that are not the recordings they are taken for"),
      field("named", &T::named, "", "mechanisms, the most important first").always(Value::array()),
      field("not_told_apart", &T::not_told_apart, "",
            "lists of ids of which each could stand for the first, or of whole sets, each an explanation")
          .always(Value::array()),
      outside_field(),
      field("contradicted", &T::contradicted, "", "names that other recordings of the document speak against"),
      field("stability", &T::stability, "", "what parts of the recordings say: explain --resample"),
      field("located", &T::located, "", "where the mismatch is; null: there is none").or_null(),
      field("held_out", &T::held_out, "", "errors on recordings that the fit never saw"),
      field("fitted", &T::fitted, "", "the same score on those that it saw"),
      field("null_test", &T::null_test, "", "is there a mismatch at all?"),
      field("noise", &T::noise, "", "what the residuals say of the stated noise"),
      field("negative_controls", &T::negative_controls, "",
            "negative controls: how often nothing would have passed for physics"),
      field("weighed", &T::weighed, "", "the answers that were held against each other, the likeliest first"),
      field("scoreboard", &T::scoreboard, "", "all hypotheses, the best first").always(Value::array()),
      field("isolability", &T::isolability, "", "what these recordings can show").always(Value::array()),
      field("compensation", &T::compensation, "", "free parameters that the missing physics had bent")
          .always(Value::array()),
      field("sentence", &T::sentence, "", "the answer").always(""),
      field("next_measurement", &T::next_measurement, "", "what would tell more; {}: nothing is proposed")};
  return table;
}

GONIO_RECORD(HeldOutScore, held_out_score_fields);
GONIO_RECORD(NullTest, null_test_fields);
GONIO_RECORD(ExplainedNoise, explained_noise_fields);
GONIO_RECORD(ContradictedName, contradicted_name_fields);
GONIO_RECORD(AnswerOfParts, answer_of_parts_fields);
GONIO_RECORD(AnswerStability, answer_stability_fields);
GONIO_RECORD(NegativeControls, negative_controls_fields);
GONIO_RECORD(ScoredHypothesis, scored_hypothesis_fields);
GONIO_RECORD(WeighedAnswer, weighed_answer_fields);
GONIO_RECORD(LookAlike, look_alike_fields);
GONIO_RECORD(MechanismVisibility, mechanism_visibility_fields);
GONIO_RECORD(IndependentValue, independent_value_fields);
GONIO_RECORD(ShiftedParameter, shifted_parameter_fields);
GONIO_RECORD(PlannedView, planned_view_fields);
GONIO_RECORD(PlannedMeasurement, planned_measurement_fields);
GONIO_RECORD(NextMeasurement, next_measurement_fields);
GONIO_RECORD(ExplanationEntry, explanation_fields);

}  // namespace gonio::manifest
