// Where an object, its lamps and what else is free are, by rims in photographs: from a stated start or from nothing,
// with what else fits as well, what no rim holds, and whether to believe it at all.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "alignment/fit.h"
#include "alignment/search.h"

namespace gonio::alignment {

struct AlignWish {
  enum class From {
    stated,
    nothing,
    either
  } from = From::either;     // either: from nothing where the stated start leads nowhere
  bool lamps_known = false;  // lamps begin where they are stated; else they are searched where that leads nowhere
  double reach_px = 60;      // of the stated start
  // Believed only where so much of the models' rims has points beside it and so many points have a rim, and what is
  // left is no more than this.
  double least_share = 0.8, most_sigma_px = 0.75;
  // A direction is open where it is known no better than to this share of the body's radius.
  double open_share = 0.03;
  SearchWish search{};
  bool record = false;  // fill Aligned::tried
};

enum class Verdict { found, ambiguous, mirrored, lost };
std::string word_of(Verdict verdict);

struct Rival {
  Setting setting;
  double worse = 0;  // its sum of squares over the best one's, in independent points of one standard deviation
  double rms_px = 0, explained = 0;
};
struct Tried {                                                              // one start, and where it led
  enum class Fate { taken, dropped, same_end, left } fate = Fate::dropped;  // left: before shadows were looked at
  std::string from;
  std::vector<double> rms_px{};  // off before each step, and at the end (FitPath)
  double explained = 0;          // of the model's rims, where all of it was fitted
};
struct PictureAnswer;  // picture_step.h
struct Aligned {
  Fitted fitted;
  Verdict verdict = Verdict::lost;
  std::string why;
  std::vector<Rival> rivals;            // that fit as well
  std::vector<std::string> open;        // directions that no rim holds
  std::vector<std::string> symmetries;  // of rivals that are turns of the found pose about one of the mesh's axes
  std::vector<Vec3> any_turn;           // unit axes of the mesh about which it looks alike by any angle
  std::vector<Tried> tried;             // the one that was taken last
  std::shared_ptr<const PictureAnswer> pictures{};  // the last step, where it was asked for
  bool stands() const { return verdict == Verdict::found || verdict == Verdict::ambiguous; }  // and may be moved there
};

// For one body, number `body`; others in the setting stay as they are, or move along where they are free.
Aligned align(const Setting& stated, const Question& question, std::size_t body, const AlignWish& wish);
// Anew, by the fit as it is now: directions of the body that no rim holds, and whether they make it ambiguous.
void judge_open(const Question& question, std::size_t body, const AlignWish& wish, Aligned& aligned);

}  // namespace gonio::alignment
