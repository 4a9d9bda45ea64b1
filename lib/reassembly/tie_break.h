// A layout of markers that fits in several ways says nothing about which of them is true; the photographs may. The
// scene is rendered with the piece in each of its candidate poses, and held against them.
//
// Small pictures (blocks of pixels averaged) of the views that have the piece before them. Where the renderings differ
// by more than their noise the pictures can tell; over those pixels, in tiles, each candidate's error is the mean of
// min(|log((v + c) / (s f + c))|, 1): v the photograph, f the rendering, s the factor of exposure (median ratio over
// the whole picture, the same for all candidates of a view by their mean), c a twentieth of the photograph's mean. The
// candidate with the smallest error is meant if it beats every other by `sigmas` standard errors of the paired
// difference over tiles.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "manifest/document.h"
#include "reassembly/place.h"

namespace gonio::reassembly {

struct TieWish {
  int longest_px = 160, spp = 32;
  double sigmas = 6;  // neighbouring tiles err together
  std::uint64_t seed = 1;
  std::filesystem::path folder{};  // where renderings may leave checkpoints; they are removed
};
struct Tie {
  std::optional<std::size_t> meant;  // which candidate
  std::string words;                 // with figures
};
// `document` has photographs, lights, surfaces and the object, whose pose is replaced. Objects without a pose are left
// out. Without lights nothing is meant.
Tie break_tie(const manifest::Document& document, const std::string& object, std::span<const Candidate> candidates,
              const TieWish& wish);

}  // namespace gonio::reassembly
