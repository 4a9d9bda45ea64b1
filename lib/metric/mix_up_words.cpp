// See mix_ups.h: the sentences. What was found is a map from files to pictures; each of its closed exchanges, and each
// chain that ends at a picture whose own file is in place or fits nothing, is one sentence.
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <set>

#include "metric/mix_ups.h"

namespace gonio::metric {
namespace {

constexpr std::size_t most_told = 4;  // of one chain, in full
constexpr std::array<const char*, 9> small_numbers = {"two",   "three", "four", "five", "six",
                                                      "seven", "eight", "nine", "ten"};

std::string number_word(std::size_t n) {
  return n >= 2 && n - 2 < small_numbers.size() ? small_numbers[n - 2] : std::to_string(n);
}

std::string per_cent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, share >= 0.995 ? "%.3g %%" : "%.2g %%", 100 * share);
  return text;
}

using Chain = std::vector<const MixUp*>;

// "The file of image a fits what b should show (error 3 % instead of 48 %), and that of b what c should show (...)"
std::string told(std::span<const PictureOfSet> set, const Chain& chain) {
  std::string text;
  for (std::size_t k = 0; k < std::min(most_told, chain.size()); ++k) {
    const MixUp& m = *chain[k];
    const bool last = k + 1 == chain.size();
    text += k == 0 ? "The file of image " : last ? ", and that of " : ", that of ";
    text += set[m.image].name + (k == 0 ? " fits what " : " what ") + set[m.shows].name + " should show (" +
            (k == 0 ? "error " : "") + per_cent(m.other) + " instead of " + per_cent(m.own) + ")";
  }
  if (chain.size() > most_told) text += ", and so on for " + std::to_string(chain.size() - most_told) + " more";
  return text;
}

bool differ_by_lights(std::span<const PictureOfSet> set, const MixUp& m) {
  return set[m.image].view == set[m.shows].view && set[m.image].lights != set[m.shows].lights;
}

std::string question(std::span<const PictureOfSet> set, const Chain& chain) {
  const std::string count = number_word(chain.size());
  const bool lights = std::ranges::all_of(chain, [&](const MixUp* m) { return differ_by_lights(set, *m); });
  if (chain.size() == 2)
    return lights ? ": are two file names swapped, or their lights (" + set[chain[0]->image].lights + " and " +
                        set[chain[1]->image].lights + ")?"
                  : ": are two file names swapped?";
  return ": are " + count + (lights ? " file names mixed up, or their lights?" : " file names mixed up?");
}

// A chain's end: a picture that another file shows, too, or whose own file is in no picture's place.
std::string open_question(std::span<const PictureOfSet> set, std::span<const MixUp> found, const Chain& chain) {
  const MixUp& last = *chain.back();
  const std::string& end = set[last.shows].name;
  const bool one = chain.size() == 1;
  for (const MixUp& m : found)
    if (m.shows == last.shows && m.image != last.image)
      return ", and so does the file of " + set[m.image].name + ": was one file used twice?";
  if (last.in_place)
    return one ? ", and so does the file of " + end + " itself: was one file used twice?"
               : "; the file of " + end + " is in its place: were files copied over others?";
  return "; what the file of " + end + " shows is not in this set: " +
         (!one                          ? "are the file names shifted?"
          : differ_by_lights(set, last) ? "is a file name wrong, or its light?"
                                        : "is a file name wrong?");
}

// Two lamps that exchange their pictures in several views.
std::string lights_sentence(std::span<const PictureOfSet> set, const std::vector<Chain>& pairs) {
  const MixUp& m = *pairs.front()[0];
  double own = 0, other = 0;
  for (const Chain& pair : pairs)
    for (const MixUp* one : pair) own = std::max(own, one->own), other = std::max(other, one->other);
  return "In " + number_word(pairs.size()) + " views the file under " + set[m.image].lights +
         " fits what should be seen under " + set[m.shows].lights + ", and the reverse (errors up to " +
         per_cent(other) + " instead of " + per_cent(own) + "): are the lights " + set[m.image].lights + " and " +
         set[m.shows].lights + " swapped?";
}

}  // namespace

std::vector<std::string> mix_up_sentences(std::span<const PictureOfSet> set, std::span<const MixUp> found) {
  std::map<std::size_t, const MixUp*> from;
  std::set<std::size_t> shown, told_already;
  for (const MixUp& m : found) from[m.image] = &m, shown.insert(m.shows);
  const auto chain_from = [&](std::size_t image) {
    Chain chain;
    std::set<std::size_t> passed;
    for (auto at = from.find(image);
         at != from.end() && !told_already.contains(at->first) && passed.insert(at->first).second;
         at = from.find(at->second->shows))
      chain.push_back(at->second);
    return chain;
  };
  std::vector<Chain> closed, open;
  for (const MixUp& m : found) {
    Chain chain = chain_from(m.image);
    if (chain.empty() || chain.back()->shows != m.image) continue;
    for (const MixUp* one : chain) told_already.insert(one->image);
    closed.push_back(std::move(chain));
  }
  for (const MixUp& m : found)  // begins at a picture that no other file shows
    if (!shown.contains(m.image)) {
      open.push_back(chain_from(m.image));
      for (const MixUp* one : open.back()) told_already.insert(one->image);
    }
  std::map<std::set<std::string>, std::vector<Chain>> by_lights;
  const auto lights_of = [&](const Chain& c) {
    return c.size() == 2 && differ_by_lights(set, *c[0])
               ? std::set<std::string>{set[c[0]->image].lights, set[c[1]->image].lights}
               : std::set<std::string>{};
  };
  for (const Chain& c : closed) by_lights[lights_of(c)].push_back(c);
  std::vector<std::string> sentences;
  for (const auto& [lights, chains] : by_lights) {
    if (!lights.empty() && chains.size() > 1) {
      sentences.push_back(lights_sentence(set, chains));
      continue;
    }
    for (const Chain& c : chains) sentences.push_back(told(set, c) + question(set, c));
  }
  for (const Chain& c : open) sentences.push_back(told(set, c) + open_question(set, found, c));
  return sentences;
}

}  // namespace gonio::metric
