// See shown_frames.h.
#include "acquisition/plan/shown_frames.h"

#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/projection.h"

namespace gonio::acquisition {
namespace {

template <class Named>
std::string names_there(const Named& all) {
  std::string names;
  for (const auto& [name, entry] : all) names += (names.empty() ? "" : ", ") + name;
  return names.empty() ? "there is none" : "there is " + names;
}

}  // namespace

ShownProjection shown_projection(const std::string& text, const std::string& place,
                                 const manifest::Document& document) {
  const auto& screens = document.laboratory.entry.front().screens;
  const std::size_t equals = text.find('=');
  ShownProjection shown;
  shown.projection = equals == std::string::npos ? text : text.substr(equals + 1);
  if (equals != std::string::npos)
    shown.screen = text.substr(0, equals);
  else if (screens.size() == 1)
    shown.screen = screens.begin()->first;
  else
    throw Error(Exit::usage, place, "does not say which screen shows " + text,
                "SCREEN=" + text + "; " + names_there(screens));
  const auto screen = screens.find(shown.screen);
  if (screen == screens.end())
    throw Error(Exit::usage, place, "\"" + shown.screen + "\" is no screen of the laboratory", names_there(screens));
  const auto projection = document.projections.find(shown.projection);
  if (projection == document.projections.end())
    throw Error(Exit::usage, place, "\"" + shown.projection + "\" is no projection of the manifest",
                names_there(document.projections) + "; structured-light --pattern writes them");
  const manifest::Projection& p = projection->second;
  const std::string at = manifest::place(document, "/projections/" + shown.projection);
  if (p.width_px != screen->second.width_px || p.height_px != screen->second.height_px)
    throw Error(
        Exit::data, at,
        format("has %lld x %lld pixels, and screen %s %lld x %lld", static_cast<long long>(p.width_px),
               static_cast<long long>(p.height_px), shown.screen.c_str(),
               static_cast<long long>(screen->second.width_px), static_cast<long long>(screen->second.height_px)),
        "nothing is scaled: make the patterns as large as the screen");
  for (std::size_t f = 0; f < p.frames.size(); ++f)
    if (p.frames[f].file.empty())
      throw Error(Exit::data, at + "/frames/" + std::to_string(f) + "/file", "missing",
                  "structured-light --pattern writes the pictures");
  return shown;
}

std::vector<manifest::PlanStep> with_frames(const std::vector<manifest::PlanStep>& steps, const ShownProjection& shown,
                                            bool boards_come_back, const manifest::Document& document) {
  const manifest::Projection& projection = document.projections.at(shown.projection);
  std::vector<manifest::PlanStep> all;
  for (const manifest::PlanStep& step : steps) {
    if (step.purpose == "reference" || (step.purpose == "board" && boards_come_back)) {
      all.push_back(step);
      continue;
    }
    if (step.exposures_s.size() > 1)
      throw Error(Exit::usage, "--exposure",
                  "is given several times, and a frame of " + shown.projection + " is one picture",
                  "give one exposure");
    for (std::size_t f = 0; f < projection.frames.size(); ++f) {
      manifest::PlanStep& frame = all.emplace_back(step);
      frame.image = format("%s-%03zu", step.image.c_str(), f);
      frame.screens[shown.screen] = projection.frames[f].file;
      frame.projection = shown.projection, frame.shows = static_cast<std::int64_t>(f), frame.group = step.image;
    }
  }
  return all;
}

}  // namespace gonio::acquisition
