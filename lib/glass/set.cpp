// See set.h.
#include "glass/set.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "glass/object.h"
#include "glass/stage.h"

namespace gonio::glass {
namespace {

// Streams of random numbers under the set's seed.
enum : std::uint64_t { split_stream = 1, object_stream = 2, view_stream = 3 };

// Shuffles by `random`.
template <class Values>
void shuffle(Values& values, Random& random) {
  for (std::size_t i = values.size(); i > 1; --i)
    std::swap(values[i - 1], values[random.below(static_cast<std::uint32_t>(i))]);
}

// A tenth of the groups, to the nearest whole, is for the test and as many for validation. Group i is of kind
// i % kinds; a share has as many of each kind as of any other, but for one: what is calibrated on a share that has too
// many of a difficult kind errs elsewhere.
std::vector<Share> split(std::size_t groups, std::size_t kinds, std::uint64_t seed) {
  Random random(seed, split_stream);
  std::vector<std::vector<std::size_t>> of_kind(kinds);
  for (std::size_t i = 0; i < groups; ++i) of_kind[i % kinds].push_back(i);
  for (auto& kind : of_kind) shuffle(kind, random);
  shuffle(of_kind, random);
  std::vector<std::size_t> order;  // one of each kind, again and again
  for (std::size_t turn = 0; order.size() < groups; ++turn)
    for (const auto& kind : of_kind)
      if (turn < kind.size()) order.push_back(kind[turn]);
  std::vector<Share> shares(groups, Share::training);
  const std::size_t held = (groups + 5) / 10;
  for (std::size_t i = 0; i < std::min(2 * held, groups); ++i)
    shares[order[i]] = i < held ? Share::test : Share::validation;
  return shares;
}

}  // namespace

const char* name_of(Share share) {
  return share == Share::training ? "training" : share == Share::validation ? "validation" : "test";
}

struct GlassSet::Object {
  std::size_t number;
  MadeObject made;
};

GlassSet::GlassSet(SetWish wish, std::filesystem::path folder) : wish_(std::move(wish)), folder_(std::move(folder)) {
  if (cells() == 0) throw Error(Exit::usage, "--objects", "asks for no cell", "give 1 or more, and 1 view or more");
  if (wish_.forms.empty())
    for (const Form* form : all_forms()) wish_.forms.emplace_back(form->id());
  std::ranges::sort(wish_.forms);  // the registry has no order
  std::ranges::sort(wish_.meshes);
  std::map<std::string, std::size_t> known;  // bodies of one content are one
  std::vector<std::size_t> group;
  for (const auto& path : wish_.meshes)
    group.push_back(known.emplace(sha256_of_file(path), known.size()).first->second);
  const std::vector<Share> of_group =
      wish_.meshes.empty() ? split(wish_.objects, wish_.forms.size(), wish_.seed) : split(known.size(), 1, wish_.seed);
  for (std::size_t i = 0; i < wish_.objects; ++i)
    shares_.push_back(of_group[wish_.meshes.empty() ? i : group[i % group.size()]]);
}

const GlassSet::Object& GlassSet::object(std::size_t number) const {
  if (last_ && last_->number == number) return *last_;
  CheckedBody body;
  std::string form = "file";
  if (wish_.meshes.empty()) {
    form = wish_.forms[number % wish_.forms.size()];
    const Form* family = find_form(form);
    if (family == nullptr) throw Error(Exit::usage, "--form", "\"" + form + "\" is no family of bodies");
    body = drawn_body(*family, wish_.seed, number);
  } else {
    body = body_in(wish_.meshes[number % wish_.meshes.size()]);
  }
  Random random(split_mix(wish_.seed) ^ number, object_stream);
  auto made = std::make_shared<Object>(Object{number, made_of_glass(std::move(body), random)});
  made->made.facts["form"] = form;
  last_ = made;
  return *last_;
}

Cell GlassSet::cell(std::size_t number) const {
  if (number >= cells())
    throw Error(Exit::usage, "--cell", format("%zu is none of %zu, counted from 0", number, cells()));
  Cell cell;
  cell.number = number, cell.object = number / wish_.views, cell.view = number % wish_.views;
  cell.share = share_of(cell.object);
  const MadeObject& made = object(cell.object).made;
  cell.facts = made.facts;
  Random random(split_mix(split_mix(wish_.seed) ^ cell.object) ^ cell.view, view_stream);
  set_the_stage(cell, made, wish_, folder_, random);
  const std::string how =
      format("%.17g %d %llu\n", wish_.relative_error, wish_.most_spp, static_cast<unsigned long long>(wish_.seed));
  cell.name = sha256(how + manifest::print_document(cell.scene, folder_)).substr(0, 16);
  return cell;
}

}  // namespace gonio::glass
