// Field tables of what an explanation says of the mismatch: which mechanisms, where, which law of no known effect.
#include "manifest/explanation_tables.h"
#include "manifest/finite_makers.h"

namespace gonio::manifest {
namespace {

Field<NamedMechanism> intervals_field() {
  return custom<NamedMechanism>(
      "interval_95", "", "[lower, upper] of each at 95 %",
      by_name(Value::object({{"type", "array"}, {"items", one_or_more_schema()}, {"minItems", 2}, {"maxItems", 2}})),
      [](NamedMechanism& m, const Value& v, const std::string& place) {
        expect_object(v, place);
        for (const auto& [key, ends] : v.as_object()) {
          if (key.starts_with("x-")) continue;
          const std::string at = place + "/" + key;
          if (!ends.is_array() || ends.as_array().size() != 2) wrong_type(ends, "[lower, upper]", at);
          m.interval_95.push_back({key, read_one_or_more(ends.as_array()[0], item(at, 0)),
                                   read_one_or_more(ends.as_array()[1], item(at, 1))});
        }
      },
      [](const NamedMechanism& m) {
        Value out = Value::object();
        for (const NamedInterval& i : m.interval_95)
          out[i.name] = Value(Value::Array{write_one_or_more(i.lower), write_one_or_more(i.upper)});
        return out;
      });
}

// Members that a record inherits.
template <class Record, class Member>
Member Record::*inherited(Member MismatchCondition::*member) {
  return static_cast<Member Record::*>(member);
}

template <class Record>
std::vector<Field<Record>> condition_fields() {
  using C = MismatchCondition;
  return {field("condition", inherited<Record>(&C::condition), "", "that carries it").always("").needed(),
          custom<Record>(
              "range", "", "[lower, upper]: what holds most of it", list_or_nulls_schema(),
              [](Record& r, const Value& v, const std::string& place) {
                expect_array(v, place);
                r.range = read_one_or_more(v, place);
              },
              [](const Record& r) { return write_list(r.range); }),
          field("unit", inherited<Record>(&C::unit), "", "of the range").always(""),
          number_field("share", inherited<Record>(&C::share), "",
                       "of the excess over noise that a smooth curve over the condition explains"),
          number_field("effect", inherited<Record>(&C::effect), "", "root mean square of that curve over the range"),
          field("effect_unit", inherited<Record>(&C::effect_unit), "", "of the effect").always("")};
}

}  // namespace

const std::vector<Field<NamedMechanism>>& named_mechanism_fields() {
  using T = NamedMechanism;
  static const std::vector<Field<T>> table{
      field("mechanism", &T::mechanism, "", "its id: gonio-mechanisms(7)").always("").needed(),
      field("on", &T::on, "", "surfaces, lights, ... that it applies to; left out: the scene"),
      field("probability", &T::probability, "", "that it is among what was left out").range(0, 1),
      numbers_by_name("parameters", &T::parameters, "as fitted: one number, or one for each name in `on`"),
      numbers_by_name("sigma", &T::sigma, "one standard deviation of each"),
      intervals_field()};
  return table;
}

const std::vector<Field<MisplacedFile>>& misplaced_file_fields() {
  using T = MisplacedFile;
  static const std::vector<Field<T>> table{
      field("group", &T::group, "", "the recording").always("").needed(),
      field("shows", &T::shows, "", "the recording that its file fits instead").always("").needed(),
      number_field("error", &T::error, "", "of the file against its own prediction, 0 to 1"),
      number_field("error_there", &T::error_there, "", "against the other's")};
  return table;
}

const std::vector<Field<BeforeAfter>>& before_after_fields() {
  using T = BeforeAfter;
  static const std::vector<Field<T>> table{
      number_field("before", &T::before, "", "score of the base model, its free parameters fitted"),
      number_field("after", &T::after, "", "score with what was found")};
  return table;
}

const std::vector<Field<TermShape>>& term_shape_fields() {
  using T = TermShape;
  static const std::vector<Field<T>> table{
      field("function", &T::function, "", "exp (of minus its argument), sin or cos").always("").needed(),
      field("of", &T::of, "", "condition that over the scale is its argument").always(""),
      number_field("scale", &T::scale, "", "of the condition"),
      number_field("scale_sigma", &T::scale_sigma, "", "one standard deviation of the scale"),
      field("scale_unit", &T::scale_unit, "", "of the scale").always("")};
  return table;
}

const std::vector<Field<LawTermFound>>& law_term_fields() {
  using T = LawTermFound;
  static const std::vector<Field<T>> table{
      number_field("coefficient", &T::coefficient, "", "in its unit"),
      number_field("sigma", &T::sigma, "", "one standard deviation of the coefficient"),
      field("unit", &T::unit, "", "of the coefficient: makes the term one of the residual").always(""),
      field("along", &T::along, "", "condition whose direction the term has").always(""),
      numbers_by_name("powers", &T::powers, "of the conditions whose product it is"),
      field("shape", &T::shape, "", "factor that is no power")};
  return table;
}

const std::vector<Field<OutsideLibrary>>& outside_library_fields() {
  using T = OutsideLibrary;
  static const std::vector<Field<T>> table{
      field("condition", &T::condition, "", "that carries the structure most").always(""),
      field("stage", &T::stage, "", "of the simulator that the condition belongs to").always(""),
      field("law", &T::law, "", "the residual as a law, in words; left out: none extrapolates"),
      field("terms", &T::terms, "", "of that law: their sum is the residual"),
      field("share", &T::share, "", "of the excess over noise that the law takes away"),
      field("extrapolated", &T::extrapolated, "", "the range that the law predicts without having seen it"),
      field("held_out", &T::held_out, "", "scores over that range")};
  return table;
}

const std::vector<Field<MismatchCondition>>& mismatch_condition_fields() {
  static const std::vector<Field<MismatchCondition>> table = condition_fields<MismatchCondition>();
  return table;
}

const std::vector<Field<MismatchBox>>& mismatch_box_fields() {
  using T = MismatchBox;
  static const std::vector<Field<T>> table{field("group", &T::group, "", "the recording").always("").needed(),
                                           field("x_px", &T::x_px, "px", "column of its top-left pixel"),
                                           field("y_px", &T::y_px, "px", "row of its top-left pixel"),
                                           field("width_px", &T::width_px, "px", "columns").range(0, 1 << 20),
                                           field("height_px", &T::height_px, "px", "rows").range(0, 1 << 20)};
  return table;
}

const std::vector<Field<MismatchGroup>>& mismatch_group_fields() {
  using T = MismatchGroup;
  static const std::vector<Field<T>> table{
      field("group", &T::group, "", "what is held out together: a view, a board, a series, ...").always("").needed(),
      number_field("share", &T::share, "", "of the excess over noise"),
      number_field("before", &T::before, "", "its score with the base model"),
      number_field("after", &T::after, "", "its score with what was found")};
  return table;
}

const std::vector<Field<LocatedMismatch>>& located_mismatch_fields() {
  using T = LocatedMismatch;
  static const std::vector<Field<T>> table = [] {
    std::vector<Field<T>> fields = condition_fields<T>();
    for (Field<T>& more : std::vector<Field<T>>{
             field("observations", &T::observations, "", "file id: the table of all observations and their residuals"),
             field("mask", &T::mask, "", "file id: pixels that hold it"),
             field("masks", &T::masks, "", "file ids, where several images hold it"),
             field("boxes", &T::boxes, "", "the same as boxes"),
             field("stage", &T::stage, "", "of the simulator: sensor, lens, light, surface, transport, pose, ..."),
             field("conditions", &T::conditions, "", "all that carry it, the most telling first")
                 .always(Value::array()),
             field("groups", &T::groups, "", "what each holds of it, the most first").always(Value::array())})
      fields.push_back(std::move(more));
    return fields;
  }();
  return table;
}

NotToldApart Codec<NotToldApart>::read(const Value& v, const std::string& place) {
  expect_array(v, place);
  NotToldApart out;
  for (std::size_t i = 0; i < v.as_array().size(); ++i) {
    const Value& one = v.as_array()[i];
    if (one.is_array())
      out.sets.push_back(Codec<std::vector<std::string>>::read(one, item(place, i)));
    else
      out.mechanisms.push_back(Codec<std::string>::read(one, item(place, i)));
  }
  return out;
}
Value Codec<NotToldApart>::write(const NotToldApart& m) {
  Value out = Value::array();
  for (const std::string& id : m.mechanisms) out.push_back(id);
  for (const auto& set : m.sets) out.push_back(Value(set));
  return out;
}
Value Codec<NotToldApart>::schema() {
  return Value::object({{"type", "array"}, {"items", defined("names")}});
}

GONIO_RECORD(NamedMechanism, named_mechanism_fields);
GONIO_RECORD(MisplacedFile, misplaced_file_fields);
GONIO_RECORD(BeforeAfter, before_after_fields);
GONIO_RECORD(TermShape, term_shape_fields);
GONIO_RECORD(LawTermFound, law_term_fields);
GONIO_RECORD(OutsideLibrary, outside_library_fields);
GONIO_RECORD(MismatchCondition, mismatch_condition_fields);
GONIO_RECORD(MismatchBox, mismatch_box_fields);
GONIO_RECORD(MismatchGroup, mismatch_group_fields);
GONIO_RECORD(LocatedMismatch, located_mismatch_fields);

}  // namespace gonio::manifest
