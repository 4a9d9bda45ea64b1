// See misread.h.
#include "explain/images/misread.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "explain/images/reading_errors.h"
#include "inference/wording.h"
#include "stats/intervals.h"

namespace gonio::explain::images {
namespace {

using Errors = std::vector<double>;  // one for each picture

constexpr double half = 0.5, third = 1.0 / 3;
constexpr double as_good = 1.1;      // an error within this factor of the least
constexpr double promising = 0.9;    // of the error without shadows: worth a look with them
constexpr std::size_t most_lit = 8;  // of these
constexpr double usual_floor = 0.05, usual_ratio = 2;
constexpr double explained_of_none = 0.05, explained_of_one = 0.1, explained_of_others = 0.5;  // of the square
constexpr std::size_t most_told_of = 4;  // pictures that a sentence lists

double pooled(const Errors& errors) {
  double square = 0;
  for (const double e : errors) square += e * e;
  return errors.empty() ? 0 : std::sqrt(square / static_cast<double>(errors.size()));
}

double pooled(const Errors& errors, const std::vector<std::size_t>& of) {
  Errors some;
  for (const std::size_t i : of) some.push_back(errors[i]);
  return pooled(some);
}

struct Finding {
  Reading reading;
  std::vector<std::size_t> pictures;  // that are meant so
  Errors other;
  double left = 0;  // over all pictures
  bool all = false;
};

std::optional<Finding> of_the_scene(const Reading& reading, const Errors& own, const Errors& other) {
  if (pooled(other) > std::min(most_other, half * pooled(own))) return {};
  Finding finding{reading, {}, other, pooled(other), true};
  std::size_t bad = 0, better = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    finding.pictures.push_back(i);
    if (own[i] <= least_own) continue;
    ++bad;
    if (other[i] <= fallen * own[i]) ++better;
  }
  if (static_cast<double>(better) < agreeing * static_cast<double>(bad)) return {};
  return finding;
}

std::optional<Finding> of_some_pictures(const Reading& reading, const Errors& own, const Errors& other) {
  Finding finding{reading, {}, other, 0, false};
  Errors rest, left = own;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (own[i] > own_of_one && other[i] <= third * own[i])
      finding.pictures.push_back(i);
    else
      rest.push_back(own[i]);
  if (rest.empty()) return {};
  const double usual = usual_ratio * std::max(usual_floor, stats::median(rest));
  std::erase_if(finding.pictures, [&](std::size_t i) { return other[i] > usual; });
  if (finding.pictures.empty()) return {};
  for (const std::size_t i : finding.pictures) left[i] = other[i];
  finding.left = pooled(left);
  return finding;
}

// Readings that the scene without its shadows speaks for, the clearest first; before them those that may hold for
// single pictures, where one of them is explained badly.
std::vector<Reading> promising_readings(const scene::Scene& scene, const ReadingErrors& errors, bool one_is_bad) {
  const double given = pooled(errors.unshadowed({}));
  std::vector<Reading> readings;
  std::vector<std::pair<double, Reading>> ranked;
  for (Reading& reading : readings_of(scene)) {
    if (reading.of_pictures && one_is_bad) {
      readings.push_back(std::move(reading));
      continue;
    }
    const double left = pooled(errors.unshadowed(reading));
    if (left <= promising * given) ranked.emplace_back(left, std::move(reading));
  }
  std::ranges::stable_sort(ranked, {}, &std::pair<double, Reading>::first);
  for (std::size_t k = 0; k < std::min(most_lit, ranked.size()); ++k) readings.push_back(std::move(ranked[k].second));
  return readings;
}

std::string listed(const Recordings& recordings, const std::vector<std::size_t>& pictures) {
  std::string text;
  for (std::size_t k = 0; k < std::min(most_told_of, pictures.size()); ++k)
    text += (k == 0 ? "`" : k + 1 == pictures.size() ? " and `" : ", `") + recordings.images[pictures[k]].id + "`";
  if (pictures.size() > most_told_of) text += " and " + std::to_string(pictures.size() - most_told_of) + " more";
  return text;
}

// "The mesh of `bunny` seems to be in millimetres", "The poses of `03` and `04` seem to be ...".
std::string fault_of(const Finding& found, const Recordings& recordings) {
  const Reading& r = found.reading;
  const bool one_picture = !found.all && found.pictures.size() == 1;
  std::string subject = r.subject;
  if (one_picture && subject.ends_with('s')) subject.pop_back();
  return "The " + subject + (found.all ? "" : " of " + listed(recordings, found.pictures)) +
         (r.plural && !one_picture ? " seem " : " seems ") + r.fault;
}

// `others`: readings that do as well, to which a body that is its own mirror image does not object.
Misplaced told(const Finding& found, const std::vector<std::string>& others, const Recordings& recordings,
               const Errors& own) {
  Misplaced misplaced;
  for (const std::size_t i : found.pictures) {
    const std::string& id = recordings.images[i].id;
    misplaced.files.push_back(
        {id, id + " with the " + found.reading.subject + " " + found.reading.remedy, own[i], found.other[i]});
  }
  const bool one = found.pictures.size() == 1;
  misplaced.sentence = fault_of(found, recordings) + ": " + found.reading.remedy + ", the relative error of " +
                       (found.all ? one ? "the picture" : "the pictures"
                        : one     ? "this picture"
                                  : "these pictures") +
                       " falls from " + inference::share_in_words(pooled(own, found.pictures)) + " to " +
                       inference::share_in_words(pooled(found.other, found.pictures));
  for (std::size_t k = 0; k < others.size(); ++k)
    misplaced.sentence += (k == 0 ? " (as well: " : "; ") + others[k] + (k + 1 == others.size() ? ")" : "");
  misplaced.sentence += ".";
  return misplaced;
}

// Pictures of which the scene explains nothing.
Misplaced strangers(const Recordings& recordings, const Errors& own, const Errors& grey) {
  std::vector<std::size_t> none;
  std::size_t explained = 0, structured = 0;
  bool all = true;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!(grey[i] > 0)) continue;
    ++structured;
    const double share = 1 - own[i] * own[i] / (grey[i] * grey[i]);
    if (share >= explained_of_others) ++explained;
    all = all && grey[i] >= grey_of_file && share <= explained_of_none;
    if (grey[i] >= grey_of_file && share <= explained_of_one) none.push_back(i);
  }
  if (none.empty() || (!all && 2 * explained <= structured)) return {};
  Misplaced misplaced;
  const bool one = none.size() == 1;
  const std::string grey_too = " better than by an even grey (relative error " +
                               inference::share_in_words(pooled(own, none)) + ", under the grey " +
                               inference::share_in_words(pooled(grey, none)) + ")";
  if (all)
    misplaced.sentence = std::string(one ? "The picture is not" : "No picture is") + " explained by this scene" +
                         grey_too +
                         ", and no other unit, axis, pose or flip helps: do pictures, meshes and poses belong to one "
                         "scene?";
  else
    misplaced.sentence = std::string(one ? "Image " : "Images ") + listed(recordings, none) + (one ? " is" : " are") +
                         " not explained by this scene" + grey_too + ", while most of the others are explained: " +
                         (one ? "is it the wrong file?" : "are they the wrong files?");
  for (const std::size_t i : none)
    misplaced.files.push_back({recordings.images[i].id, "nothing of this scene", own[i], grey[i]});
  return misplaced;
}

}  // namespace

Misplaced misread(const scene::Scene& scene, const ImageModel& model) {
  const ReadingErrors errors(scene, model);
  const Errors own = errors.as_given();
  if (own.empty() || (pooled(own) <= least_own && std::ranges::max(own) <= own_of_one)) return {};
  const Recordings& recordings = model.recordings();
  std::vector<Finding> findings;
  for (const Reading& reading : promising_readings(scene, errors, std::ranges::max(own) > own_of_one)) {
    const Errors other = errors.lit(reading);
    std::optional<Finding> found;
    if (pooled(own) > least_own) found = of_the_scene(reading, own, other);
    if (!found && reading.of_pictures) found = of_some_pictures(reading, own, other);
    if (found) findings.push_back(std::move(*found));
  }
  if (findings.empty()) return strangers(recordings, own, errors.grey());
  const Finding& best = *std::ranges::min_element(findings, {}, &Finding::left);
  std::vector<std::string> others;
  for (const Finding& f : findings)
    if (&f != &best && f.left <= as_good * best.left)
      others.push_back("the " + f.reading.subject + " " + f.reading.remedy);
  return told(best, others, recordings, own);
}

}  // namespace gonio::explain::images
