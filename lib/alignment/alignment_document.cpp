// See alignment_document.h.
#include "alignment/alignment_document.h"

#include <algorithm>

#include "alignment/align_bodies.h"
#include "alignment/alignment_entry.h"
#include "alignment/alignment_page.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/document.h"

namespace gonio::alignment {
namespace {

void say(const AlignmentInput& in, const std::vector<Aligned>& all) {
  for (std::size_t b = 0; b < all.size(); ++b) {
    const Fitted& f = all[b].fitted;
    log(all[b].verdict == Verdict::found ? LogLevel::info : LogLevel::warning,
        in.bodies[b] + ": " + word_of(all[b].verdict) + (all[b].why.empty() ? "" : ": " + all[b].why) +
            format("; rims %.2f px off (rms), %.1f %% of the model's rims seen", f.rms_px, 100 * f.explained));
  }
  const auto stands = std::find_if(all.begin(), all.end(), [](const Aligned& a) { return a.stands(); });
  if (stands == all.end()) return;
  if (const auto& answer = stands->pictures)
    log(answer->taken ? LogLevel::info : LogLevel::warning, "pictures: " + words_of(*answer));
  for (const std::size_t l : loose_lamps(in, stands->fitted))
    log(LogLevel::warning, "lamp " + in.lamp_words(l) + ": no rim holds its place; it stays where it is stated");
}

}  // namespace

void check_alignment(const manifest::Document& document, const AlignmentRequest& request) {
  for (const std::string& name : request.input.carried)  // before masks are looked for, which takes a while
    if (!document.lights.contains(name))
      throw Error(Exit::usage, "--carried", "names \"" + name + "\", which is no light of the manifest",
                  "give one of its lights");
  if (request.masks.by != MaskWish::By::given) return;
  const AlignmentInput in = read_alignment(document, request.input, {});
  if (request.pictures) check_pictures(document, in);
}

Verdict align_document(manifest::Document& document, const AlignmentRequest& request) {
  find_masks(document, request.masks, request.output_path, request.note_input);
  const AlignmentInput in = read_alignment(document, request.input, request.note_input);
  AlignWish wish = request.wish;
  wish.record = !request.page.empty();
  std::vector<Aligned> all = align_bodies(in, wish);
  if (request.pictures) refine_by_pictures(document, in, wish, *request.pictures, all);
  say(in, all);
  Verdict worst = Verdict::found;
  document.alignments.clear();
  for (std::size_t b = 0; b < all.size(); ++b) {
    worst = std::max(worst, all[b].verdict);
    document.alignments.push_back(entry_of(in, b, all[b]));
  }
  // A body that was found, or is one of several alike, moves; one that is lost stays where it was stated.
  for (std::size_t b = 0; b < all.size(); ++b)
    if (all[b].stands()) move_document(document, in, b, all[b]);
  const auto stands = std::find_if(all.begin(), all.end(), [](const Aligned& a) { return a.stands(); });
  if (stands != all.end()) enter_carried(document, in, stands->fitted);
  const Aligned& first = all.front();
  for (std::size_t k = 0; k < in.rims.size(); ++k) {
    manifest::Outline& outline = document.outlines[in.rims[k].outline];
    if (k >= first.fitted.sightings.size()) continue;
    const SightingFit& fit = first.fitted.sightings[k];
    enter_figures(fit, outline);
    const std::string lamp = outline.kind == "shadow" ? outline.light : "";  // there may be one of each lamp
    if (!request.output_path) continue;
    const auto path = request.output_path(file_stem(outline.image) + "-" + file_stem(outline.object) + "-" +
                                          outline.kind + (lamp.empty() ? "" : "-" + file_stem(lamp)) + ".csv");
    write_file(path, point_table(in, first.fitted.setting, k, fit));
    outline.file = manifest::add_file(
        document, path,
        "outline-" + outline.image + "-" + outline.object + "-" + outline.kind + (lamp.empty() ? "" : "-" + lamp));
  }
  if (!request.page.empty()) write_file(request.page, alignment_page(document, in, all));
  return worst;
}

}  // namespace gonio::alignment
