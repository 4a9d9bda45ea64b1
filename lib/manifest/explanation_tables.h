// The field tables of "explanations" and the codecs that follow from them (explanation_tables.cpp).
#pragma once
#include <vector>

#include "manifest/fields.h"
#include "manifest/sections/explanation.h"

namespace gonio::manifest {

GONIO_TABLE(NamedMechanism, named_mechanism_fields);
GONIO_TABLE(WeighedAnswer, weighed_answer_fields);
GONIO_TABLE(MisplacedFile, misplaced_file_fields);
GONIO_TABLE(BeforeAfter, before_after_fields);
GONIO_TABLE(TermShape, term_shape_fields);
GONIO_TABLE(LawTermFound, law_term_fields);
GONIO_TABLE(OutsideLibrary, outside_library_fields);
GONIO_TABLE(MismatchCondition, mismatch_condition_fields);
GONIO_TABLE(MismatchBox, mismatch_box_fields);
GONIO_TABLE(MismatchGroup, mismatch_group_fields);
GONIO_TABLE(LocatedMismatch, located_mismatch_fields);
GONIO_TABLE(HeldOutScore, held_out_score_fields);
GONIO_TABLE(NullTest, null_test_fields);
GONIO_TABLE(ExplainedNoise, explained_noise_fields);
GONIO_TABLE(ContradictedName, contradicted_name_fields);
GONIO_TABLE(AnswerOfParts, answer_of_parts_fields);
GONIO_TABLE(AnswerStability, answer_stability_fields);
GONIO_TABLE(NegativeControls, negative_controls_fields);
GONIO_TABLE(ScoredHypothesis, scored_hypothesis_fields);
GONIO_TABLE(LookAlike, look_alike_fields);
GONIO_TABLE(MechanismVisibility, mechanism_visibility_fields);
GONIO_TABLE(IndependentValue, independent_value_fields);
GONIO_TABLE(ShiftedParameter, shifted_parameter_fields);
GONIO_TABLE(PlannedView, planned_view_fields);
GONIO_TABLE(PlannedMeasurement, planned_measurement_fields);
GONIO_TABLE(NextMeasurement, next_measurement_fields);
GONIO_TABLE(ExplanationEntry, explanation_fields);

template <>
struct Codec<NotToldApart> {
  static NotToldApart read(const Value& value, const std::string& place);
  static Value write(const NotToldApart& member);
  static Value schema();
};

}  // namespace gonio::manifest
