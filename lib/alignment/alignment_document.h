// A manifest's objects placed by their rims and their shadows' rims.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "alignment/align.h"
#include "alignment/alignment_input.h"
#include "alignment/found_masks.h"
#include "alignment/picture_step.h"
#include "manifest/sections/forward.h"

namespace gonio::alignment {

struct AlignmentRequest {
  MaskWish masks{};
  InputWish input{};
  AlignWish wish{};
  std::optional<PictureWish> pictures{};                                        // refine by them at the end
  std::filesystem::path page{};                                                 // report to write; empty: none
  std::function<std::filesystem::path(const std::string& name)> output_path{};  // empty: no files
  std::function<void(const std::filesystem::path&)> note_input{};
};

// Reads what the alignment would, where masks are given: Error(data | usage) where it cannot be done.
void check_alignment(const manifest::Document& document, const AlignmentRequest& request);

// Enters `alignments`, figures of `outlines` with tables of their points, and, of objects that were found: their
// world_from_object, lamps' position_m, cameras' poses and focal lengths, and mechanisms/geometry.shrinkage for scales.
// What was found is logged. The worst verdict is returned.
Verdict align_document(manifest::Document& document, const AlignmentRequest& request);

}  // namespace gonio::alignment
