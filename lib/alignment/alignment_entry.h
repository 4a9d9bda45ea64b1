// What align() found, as the manifest says it. Private to alignment/.
#pragma once
#include "alignment/align.h"
#include "alignment/alignment_input.h"
#include "alignment/picture_step.h"
#include "manifest/sections/alignment.h"

namespace gonio::alignment {

manifest::Alignment entry_of(const AlignmentInput& in, std::size_t body, const Aligned& found);
// What pictures say of the body, of all freedoms.
manifest::AlignedPictures pictures_entry(const AlignmentInput& in, std::size_t body, const PictureAnswer& answer);
void enter_figures(const SightingFit& fit, manifest::Outline& outline);

// Lamps that are asked for, and whose place no rim holds: known no better than to half of their distance.
std::vector<std::size_t> loose_lamps(const AlignmentInput& in, const Fitted& fitted);

// Moves objects, lamps, cameras and the ground of the document to where they were found, with standard deviations.
// Loose lamps stay where they are stated.
void move_document(manifest::Document& document, const AlignmentInput& in, std::size_t body, const Aligned& found);

// Places of carried lamps as `light_positions`, for handeye --light: one for every pose of the tool at which rims hold
// it, with its covariance. Entries of these lamps that were there are replaced.
void enter_carried(manifest::Document& document, const AlignmentInput& in, const Fitted& fitted);

// The table of a rim's points: align(1), FILES.
std::string point_table(const AlignmentInput& in, const Setting& setting, std::size_t sighting, const SightingFit& fit);

}  // namespace gonio::alignment
