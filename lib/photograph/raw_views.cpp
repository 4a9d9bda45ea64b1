// See raw_views.h.
#include "photograph/raw_views.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>

#include "base/error.h"
#include "io/camera_raw.h"
#include "io/exif.h"

namespace gonio::photograph {
namespace {

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0;
}

// What separates a view's name from its exposure says nothing.
std::string without_tail(std::string name) {
  while (!name.empty() && !is_word(name.back())) name.pop_back();
  return name;
}

struct Frame {
  std::filesystem::path path;
  std::optional<double> exposure_s;  // stated, or in the name
  std::string view;                  // by the name
};

// By the file, where nothing else says it.
double exposure_of(const Frame& frame, const RawStated& stated) {
  if (frame.exposure_s) return *frame.exposure_s;
  const auto said = io::is_camera_raw(frame.path) ? read_raw_frame(frame.path, stated).exposure_s
                                                  : io::exif_of(frame.path).exposure_s;
  if (!said)
    throw Error(Exit::data, frame.path.string(), "does not say how long it was exposed",
                "state the exposures, or write them into the names: scene_20ms.png");
  return *said;
}

}  // namespace

std::optional<NamedExposure> exposure_in_name(const std::string& stem) {
  std::optional<NamedExposure> found;
  for (std::size_t i = 0; i < stem.size(); ++i) {
    if (std::isdigit(static_cast<unsigned char>(stem[i])) == 0 ||
        (i > 0 && (is_word(stem[i - 1]) || stem[i - 1] == '.')))
      continue;
    double number = 0;
    const auto [end, error] =
        std::from_chars(stem.data() + i, stem.data() + stem.size(), number, std::chars_format::fixed);
    if (error != std::errc()) continue;
    const std::string rest(end, stem.data() + stem.size());
    for (const auto& [unit, seconds] : {std::pair{"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0}}) {
      const std::string u = unit;
      if (!rest.starts_with(u) || (rest.size() > u.size() && is_word(rest[u.size()]))) continue;
      if (number > 0) found = NamedExposure{number * seconds, i};
      break;
    }
  }
  return found;
}

Grouping usual_grouping(const std::vector<std::filesystem::path>& frames) {
  const bool named =
      std::ranges::all_of(frames, [](const auto& path) { return exposure_in_name(path.stem().string()).has_value(); });
  return named ? Grouping::names : Grouping::sequence;
}

std::vector<RawView> raw_views(const std::vector<std::filesystem::path>& paths, const std::vector<double>& exposures_s,
                               Grouping grouping, const RawStated& stated) {
  std::vector<RawView> views;
  std::set<std::string> taken;
  const auto open = [&](const std::string& wanted) {
    std::string name = wanted.empty() ? "view" : wanted;
    for (int k = 2; !taken.insert(name).second; ++k) name = wanted + "-" + std::to_string(k);
    views.push_back({name, {}, {}});
  };
  std::vector<double> seen;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const std::string stem = paths[k].stem().string();
    const auto named = exposure_in_name(stem);
    Frame frame{paths[k], {}, without_tail(named ? stem.substr(0, named->at) : stem)};
    if (!exposures_s.empty())
      frame.exposure_s = exposures_s[k];
    else if (named)
      frame.exposure_s = named->exposure_s;
    RawView* view = nullptr;
    switch (grouping) {
      case Grouping::names: {
        if (!named)
          throw Error(Exit::data, paths[k].string(), "has no exposure in its name",
                      "name files like scene_20ms.png, or group them by --views sequence, one or each");
        const auto same = std::ranges::find(views, frame.view, &RawView::name);
        const auto at = static_cast<std::size_t>(same - views.begin());
        if (at == views.size()) open(frame.view);
        view = &views[at];
        break;
      }
      case Grouping::sequence: {
        frame.exposure_s = exposure_of(frame, stated);
        if (views.empty() || std::ranges::find(seen, *frame.exposure_s) != seen.end()) open(stem), seen.clear();
        seen.push_back(*frame.exposure_s);
        view = &views.back();
        break;
      }
      case Grouping::one:
        if (views.empty()) open(frame.view);
        view = &views.back();
        break;
      case Grouping::each:
        open(stem);
        view = &views.back();
        break;
    }
    view->frames.push_back(paths[k]);
    view->exposures_s.push_back(frame.exposure_s);
  }
  return views;
}

}  // namespace gonio::photograph
