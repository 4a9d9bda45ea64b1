// One piece against the points that are still open: what fits, and whether that is an answer. For sources of this
// folder.
#pragma once
#include <string>
#include <vector>

#include "reassembly/pair_match.h"

namespace gonio::reassembly {

struct Judged {
  Verdict verdict = Verdict::lost;
  std::string why;
  std::vector<Match> fits;  // placed: the one; ambiguous: all; poor: some; mirrored, scaled: the best
  double scale = 1;         // that of fits, times that which the search began with
};
std::vector<Spot> spots_of(const Piece& piece);
std::vector<Spot> mirrored(std::vector<Spot> spots);
Judged judged(const Piece& piece, const Points& points, const PlaceWish& wish);

}  // namespace gonio::reassembly
