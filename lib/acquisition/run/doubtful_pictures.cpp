// See doubtful_pictures.h.
#include "acquisition/run/doubtful_pictures.h"

#include <algorithm>

#include "stats/intervals.h"

namespace gonio::acquisition {

std::vector<std::string> doubtful_pictures(const std::map<std::string, FrameRecord>& records,
                                           const std::map<std::pair<std::string, double>, FrameFigures>& dark) {
  std::vector<std::string> words;
  std::map<std::string, std::vector<double>> focus;
  for (const auto& [id, r] : records) focus[r.camera].push_back(r.figures.focus);
  for (const auto& [id, r] : records) {
    const bool single = r.group == r.image;
    if (single && r.figures.saturated_share > 0.01)
      words.push_back(words_of(r) + ": saturated; ask a bracket, or a shorter exposure");
    const auto without = dark.find({r.camera, r.exposure_s});
    if (single && r.figures.saturated_share <= 0.01 && without != dark.end() && !r.lamps.empty() &&
        r.figures.bright_code < without->second.bright_code + 10 * std::max(0.5, r.figures.noise))
      words.push_back(words_of(r) + ": underexposed; ask a bracket, or a longer exposure");
    const double usual = stats::median(focus[r.camera]);
    if (single && !r.lamps.empty() && r.figures.focus < 0.25 * usual && focus[r.camera].size() >= 5)
      words.push_back(words_of(r) + ": less sharp than the others");
  }
  return words;
}

}  // namespace gonio::acquisition
