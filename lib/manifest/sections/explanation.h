// "explanations": what explain found, one entry for each of its domains. A number that is not finite is null in JSON.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "manifest/pose.h"
#include "manifest/value.h"

namespace gonio::manifest {

inline constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

// In the order in which they are written; one number stands for a list of one.
using NamedNumbers = std::vector<std::pair<std::string, std::vector<double>>>;
struct NamedInterval {
  std::string name;
  std::vector<double> lower, upper;
};

struct NamedMechanism {
  std::string mechanism;              // canonical id
  std::vector<std::string> on;        // surfaces, lights, ... that it applies to; empty: the scene
  std::optional<double> probability;  // that it is among what was left out
  NamedNumbers parameters, sigma;
  std::vector<NamedInterval> interval_95;
};

// One of the answers that were held against each other: mechanisms together, or none of them.
struct WeighedAnswer {
  std::string answer;  // mechanisms, nothing, outside
  std::vector<std::string> mechanisms;
  double probability = not_known;
  NamedNumbers statistics;
};

// Mechanisms of which each could stand in the first one's place, or whole sets of them, each an explanation of its own.
struct NotToldApart {
  std::vector<std::string> mechanisms;
  std::vector<std::vector<std::string>> sets;
};

struct MisplacedFile {
  std::string group, shows;                           // the recording, and the one whose prediction its file fits
  double error = not_known, error_there = not_known;  // 0 .. 1
};

struct BeforeAfter {
  double before = not_known, after = not_known;
};

struct TermShape {  // a dimensionless function of a condition over its scale
  std::string function, of;
  double scale = not_known, scale_sigma = not_known;
  std::string scale_unit;
};
struct LawTermFound {
  double coefficient = not_known, sigma = not_known;
  std::string unit, along;
  NamedNumbers powers;
  std::optional<TermShape> shape;
};
struct OutsideLibrary {
  std::string condition, stage;  // that carry the structure most
  std::string law;               // in words; empty: none extrapolates
  std::vector<LawTermFound> terms;
  std::optional<double> share;
  std::string extrapolated;
  std::optional<BeforeAfter> held_out;
};

struct MismatchCondition {
  std::string condition;
  std::vector<double> range;
  std::string unit;
  double share = not_known, effect = not_known;
  std::string effect_unit;
};
struct MismatchBox {
  std::string group;
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;
};
struct MismatchGroup {
  std::string group;
  double share = not_known, before = not_known, after = not_known;
};
struct LocatedMismatch : MismatchCondition {  // the most telling condition, and
  std::string observations, mask;             // file ids
  std::vector<std::string> masks;             // where there are several
  std::vector<MismatchBox> boxes;
  std::string stage;
  std::vector<MismatchCondition> conditions;
  std::vector<MismatchGroup> groups;
};

struct HeldOutScore {
  double before = not_known, after = not_known;
  std::string unit, score, how;
  std::vector<std::string> test_groups;
};
struct NullTest {
  double p = not_known;
  std::optional<bool> significant, important;
  double smallest_effect = not_known;
};
struct ExplainedNoise {
  double factor = not_known;
  std::int64_t blocks_set_aside = 0;
  std::int64_t outlying_readings = 0;
  double outlying_effect = not_known;
  std::vector<std::string> groups_set_aside{};
};
struct NegativeControls {
  std::int64_t run = 0;
  double passed_share = not_known;
};
struct ScoredHypothesis {
  std::string hypothesis;
  double held_out = not_known, gain = not_known, gain_sigma = not_known, effect = not_known;
  std::optional<double> p_neutral;
  std::string refused;
};
struct LookAlike {
  std::string mechanism;
  double cosine = not_known;
};
struct MechanismVisibility {  // "isolability"
  std::string mechanism;
  std::vector<std::string> on;
  double surviving_share = not_known;
  NamedNumbers detection_limit, limit_with_others;
  std::vector<LookAlike> looks_like;
  bool visible = true;
};
struct IndependentValue {
  double value = not_known;
  std::optional<double> sigma;
};
struct ShiftedParameter {  // "compensation"
  std::string parameter;
  double before = not_known, after = not_known, sigma = not_known;
  std::string unit;
  std::optional<IndependentValue> calibrated;
  std::optional<bool> towards;
};

struct PlannedView {
  std::string camera, board;
  std::optional<Pose<frame::Camera, frame::Board>> camera_from_board;
};
struct PlannedMeasurement {
  std::string sentence;
  Value setup = Value::object();
  std::vector<std::string> separates;
  double z = not_known;
};
struct NextMeasurement {
  std::string sentence;
  std::vector<PlannedMeasurement> plan;
};

struct ContradictedName {
  std::string mechanism, by, quantity;
  double before = not_known, after = not_known;
  std::string unit;
};
struct AnswerOfParts {
  std::string verdict;
  std::vector<std::string> named;
  std::int64_t times = 0;
};
struct AnswerStability {
  std::int64_t draws = 0, groups = 0, same = 0;
  std::vector<AnswerOfParts> answers;
};

struct ExplanationEntry {
  std::string domain, verdict;
  std::optional<double> probability;  // of the verdict
  std::vector<MisplacedFile> misplaced;
  std::vector<NamedMechanism> named;
  std::vector<NotToldApart> not_told_apart;
  std::optional<OutsideLibrary> outside;
  std::vector<ContradictedName> contradicted;
  std::optional<AnswerStability> stability;
  std::optional<LocatedMismatch> located;
  HeldOutScore held_out;
  BeforeAfter fitted;
  NullTest null_test;
  ExplainedNoise noise;
  NegativeControls negative_controls;
  std::vector<WeighedAnswer> weighed;
  std::vector<ScoredHypothesis> scoreboard;
  std::vector<MechanismVisibility> isolability;
  std::vector<ShiftedParameter> compensation;
  std::string sentence;
  NextMeasurement next_measurement;
};

}  // namespace gonio::manifest
