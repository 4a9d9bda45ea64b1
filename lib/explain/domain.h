// Domains: kinds of recordings that `explain` understands. Each is one file in lib/explain/domains/ (the stem names the
// function: tables.cpp defines `const Domain& tables()` in namespace gonio::explain::domains); the build gathers them.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "explain/engine.h"
#include "inference/explanation.h"

namespace gonio::explain {

// What the user said about the recordings beside the manifest.
struct ProblemOptions {
  std::vector<std::filesystem::path> repeats;  // further takes of the same recordings, from which noise is measured
  double budget_s = 0;  // of the whole run; 0: none. Turned into an amount of work, never into a clock: the same
                        // recordings, options and budget give the same answer on every machine
};

// Mechanisms that recordings of a domain cannot show: an id, or how ids begin ("robot."), of which the longest counts.
struct Untouched {
  std::string ids;
  std::string why;  // in words that hold for all of them
};

// What recordings that had no part in an answer say of it: a quantity of theirs that is smaller the truer the answer
// is, without what it names and with it.
struct Testimony {
  std::string by, quantity, unit;  // "the arm", "turn of the board between its poses", "rad"
  double before = 0, after = 0;    // root mean squares over its recordings
  double errors = 0;               // by how many standard errors (over recordings) the mean square grows

  bool refuted = false;  // by a rule of the witness's own
  // One right answer in a thousand is contradicted by chance; and what grows by less than a twentieth is no objection.
  bool contradicts() const { return refuted || (errors > 3 && after > 1.05 * before); }
};

struct Domain {
  std::string name;      // "boards", "images", "tables": the folder's
  std::string sentence;  // what recordings it takes
  int order = 0;         // in which problems are explained and reported
  // Name of the domain whose answer its recordings are held against, mended: pictures against the camera that the
  // boards show. `needs_it`: where nothing mends that, it is not asked.
  std::string after{};
  bool needs_it = false;
  // What it leaves to another domain of the same recordings: mechanisms whose ids begin so ("lens.") are named here
  // only where that domain names them. Corners say of the lens all that poses fitted to them could say.
  std::string leaves{}, leaves_to{};
  // Name of the domain whose answers its recordings are a witness of (explain/witness.h); empty: of none. `testify`
  // compares the document without what was named and with it.
  std::string witness_of{};
  std::vector<Testimony> (*testify)(const manifest::Document& stated, const manifest::Document& mended) = nullptr;
  // What the domain's own fit says against a candidate that it has named.
  std::optional<Testimony> (*objects)(const Problem& problem, const Explanation& e, std::size_t candidate) = nullptr;
  bool (*applies)(const manifest::Document& document) = nullptr;
  // Throws Error(data) where recordings need what the domain's simulation does not have: no fault of theirs. Where
  // others can be asked, these are left out with a warning; else it is the answer.
  void (*within_reach)(const manifest::Document& document) = nullptr;
  std::vector<std::unique_ptr<Problem>> (*problems)(const manifest::Document& document,
                                                    const ProblemOptions& options) = nullptr;
  // Files of the manifest that the problems read, for provenance.
  std::vector<std::filesystem::path> (*files)(const manifest::Document& document) = nullptr;
  // Why the mechanisms that do not declare this domain are no hypotheses here. tests/explain/product_test.cpp demands a
  // reason for each; explain --list --domains and gonio-mechanisms(7) print them.
  std::vector<Untouched> untouched{};
};

std::span<const Domain* const> all_domains();  // sorted by name; defined in a generated source

}  // namespace gonio::explain
