// What explain answered to a case, read from the manifest and the evidence that it wrote.
#pragma once
#include <filesystem>
#include <map>
#include <optional>

#include "manifest/value.h"
#include "sealed/sealed_case.h"

namespace gonio::sealed {

struct Fitted {
  std::string mechanism, parameter;
  double value = 0, lower = 0, upper = 0;
};
struct Answer {
  bool begun = false, ran = false;  // begun: the program was started and ended; ran: it answered
  int exit = 0;
  double seconds = 0, processor_seconds = 0;
  std::string error;                                // of a run that failed
  std::string verdict;                              // null, named, ambiguous, unknown
  std::vector<std::string> elsewhere;               // named in another domain's explanation of the same recordings
  std::vector<std::string> named, reported, minor;  // reported: named and what is not told apart from them
  std::size_t set_size = 0;                         // of the largest set in the answer
  std::vector<Fitted> fitted;
  // mechanism -> parameter -> detection limit: of a number alone, and whatever the mechanism's other numbers do.
  std::map<std::string, std::map<std::string, double>> limit, limit_with_others;
  std::vector<std::string> invisible;
  std::string condition, stage, sentence;
  double before = 0, after = 0;
  std::optional<double> probability;  // stated: that the verdict is right, see is_right() in judge.h
  // Of the evidence against the truth, where that can be asked: observations that hold most of the effect, and all that
  // show any.
  std::optional<double> auc, auc_any;
};

// `folder`: the case's, where out.json, out/ and status.txt lie.
Answer read_answer(const std::filesystem::path& folder, const Case& sealed);
// Area under the receiver operating characteristic of `score` for the rows that `affected` marks; nothing where fewer
// than one row in twenty is on either side.
std::optional<double> area_under_curve(const Numbers& score, const std::vector<bool>& affected);
// Which observations an effect (in noise widths) acts on: on all those of at least one noise width; or, with `most`, on
// those of at least its root mean square too. However strong an effect is, it has places where the fair refit makes it
// cross zero, and these depend on how the refit weighs the rows: that they are told from the rest is no question of
// where the effect is.
std::vector<bool> affected(const Numbers& effect, bool most);

// mechanism -> conditions in which it is seen, from what explain --list prints.
using Declared = std::map<std::string, std::vector<std::string>>;
Declared declared_conditions(const std::string& list);

}  // namespace gonio::sealed
