// The domains that a manifest offers to explain. Each of its tables, scenes, sets becomes one problem.
#pragma once
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "explain/domain.h"

namespace gonio::explain {

// The problems of all domains that apply, in their order. Error(data) where there is none.
std::vector<std::unique_ptr<Problem>> problems_of(const manifest::Document& document,
                                                  const ProblemOptions& options = {});

// The same, domain by domain. Those that wait for another's answer (Domain::after), where that is asked, have no
// problems yet.
struct AskedDomain {
  const Domain* domain = nullptr;
  bool waits = false;
  std::vector<std::unique_ptr<Problem>> problems;
};
std::vector<AskedDomain> domains_of(const manifest::Document& document, const ProblemOptions& options);

// An answer that was given: its problem, and what was said.
struct Answered {
  const Problem* problem = nullptr;
  const Explanation* explanation = nullptr;
};
// Mechanisms that `domain` leaves to one of `before` (Domain::leaves), and that this one looked at and did not name.
std::set<std::string> refused_before(const Domain& domain, std::span<const Answered> before);
// The explanation of `problem` in which none of `refused` is named: where one is, it is asked again without that one.
// What they could explain still counts as a mismatch. `left_out`: groups that count as not recorded.
Explanation explain_without(const Problem& problem, const Options& options, const std::set<std::string>& refused,
                            const std::vector<std::size_t>& left_out = {});

// Options that ask for all that `options` does but `refused`; nothing where that would be none.
std::optional<Options> asked_without(const Problem& problem, Options options, const std::set<std::string>& refused);

// Files of the manifest that these problems read: pictures, masks, meshes, tables, calibrations of robots.
std::vector<std::filesystem::path> files_of(const manifest::Document& document);

}  // namespace gonio::explain
