// Witnesses of a name: other recordings of the same manifest, and what the fit itself gives away. An arm that carried
// the camera from pose to pose knows nothing of lenses and shutters: where a mechanism that the corners name is true,
// the board's poses that were fitted with it agree with the arm better than those without it, or as well. Where they
// agree worse, the name does not stand.
#pragma once
#include <set>
#include <string>

#include "explain/domain.h"
#include "explain/engine.h"

namespace gonio::explain {

// The explanation of a problem of `domain` in which none of `refused` is named, nor anything that a witness
// (Domain::testify) or the domain itself (Domain::objects) contradicts. Of several names the one is taken back without
// which there is no contradiction, and all of them where there is no such one; what was taken back stands in
// Explanation::contradicted. Where nothing else was asked for, the name stands with the contradiction beside it.
// `document` is what the problem was made of; `left_out` as for explain_without(): of a part of the recordings only the
// domain itself objects, and what witnesses know of the whole is the caller's to refuse.
Explanation explain_before_witnesses(const Domain& domain, const Problem& problem, const Options& options,
                                     const std::set<std::string>& refused, const manifest::Document& document,
                                     const std::vector<std::size_t>& left_out = {});

}  // namespace gonio::explain
