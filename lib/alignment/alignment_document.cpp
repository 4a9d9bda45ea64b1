// See alignment_document.h.
#include "alignment/alignment_document.h"

#include <algorithm>

#include "alignment/alignment_entry.h"
#include "alignment/alignment_page.h"
#include "alignment/rim_bias.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"

namespace gonio::alignment {
namespace {

// One body's sightings and freedoms: the others neither move nor say anything.
Question of_body(const Question& question, std::size_t body) {
  Question q = question;
  std::erase_if(q.sightings, [&](const Sighting& s) { return s.subject.body != body; });
  std::erase_if(q.contacts, [&](const Contact& c) { return c.body != body; });
  return q;
}

bool own_block(Block block) {
  return block == Block::body_turn || block == Block::body_shift || block == Block::body_scale;
}

// Once more without what pixels and smoothing do to rims, which is known where these nearly are.
void refine(const AlignmentInput& in, const std::vector<Freedom>& freedoms, Fitted& fitted) {
  for (int round = 0; round < 2; ++round) {
    Question q = without_bias(in, fitted.setting);
    q.freedoms = freedoms;
    fitted = fit_rims(fitted.setting, q, {{.reach_px = 5, .width_px = 0, .most_steps = 15, .small_fall = 1e-7}});
  }
}

// Body by body, each with all that is common; then, where there are several, all together.
std::vector<Aligned> align_all(const AlignmentInput& in, const AlignWish& wish) {
  std::vector<Aligned> all;
  if (in.bodies.size() == 1) {
    all.push_back(align(in.stated, in.question, 0, wish));
    if (all[0].verdict == Verdict::found || all[0].verdict == Verdict::ambiguous)
      refine(in, in.question.freedoms, all[0].fitted);
    return all;
  }
  Setting setting = in.stated;
  for (std::size_t b = 0; b < in.bodies.size(); ++b) {
    Question q = of_body(in.question, b);
    std::erase_if(q.freedoms, [&](const Freedom& f) { return own_block(f.block) && f.which != b; });
    std::erase_if(q.freedoms, [&](const Freedom& f) {
      return f.block == Block::lamp_shift && std::none_of(q.sightings.begin(), q.sightings.end(),
                                                          [&](const Sighting& s) { return s.subject.lamp == f.which; });
    });
    all.push_back(align(setting, q, b, wish));
    if (all.back().verdict != Verdict::lost && all.back().verdict != Verdict::mirrored)
      setting = all.back().fitted.setting;
  }
  Fitted together = fit_rims(setting, in.question, stages_from(8));
  refine(in, in.question.freedoms, together);
  for (Aligned& a : all) a.fitted = together;
  return all;
}

void say(const AlignmentInput& in, const std::vector<Aligned>& all) {
  for (std::size_t b = 0; b < all.size(); ++b) {
    const Fitted& f = all[b].fitted;
    log(all[b].verdict == Verdict::found ? LogLevel::info : LogLevel::warning,
        in.bodies[b] + ": " + word_of(all[b].verdict) + (all[b].why.empty() ? "" : ": " + all[b].why) +
            format("; rims %.2f px off (rms), %.1f %% of the model's rims seen", f.rms_px, 100 * f.explained));
  }
}

}  // namespace

void check_alignment(const manifest::Document& document, const AlignmentRequest& request) {
  read_alignment(document, request.input, {});
}

Verdict align_document(manifest::Document& document, const AlignmentRequest& request) {
  const AlignmentInput in = read_alignment(document, request.input, request.note_input);
  const std::vector<Aligned> all = align_all(in, request.wish);
  say(in, all);
  Verdict worst = Verdict::found;
  document.alignments.clear();
  for (std::size_t b = 0; b < all.size(); ++b) {
    worst = std::max(worst, all[b].verdict);
    document.alignments.push_back(entry_of(in, b, all[b]));
  }
  // A body that was found, or is one of several alike, moves; one that is lost stays where it was stated.
  for (std::size_t b = 0; b < all.size(); ++b)
    if (all[b].verdict == Verdict::found || all[b].verdict == Verdict::ambiguous)
      move_document(document, in, b, all[b]);
  const Aligned& first = all.front();
  for (std::size_t k = 0; k < in.rims.size(); ++k) {
    manifest::Outline& outline = document.outlines[in.rims[k].outline];
    if (k >= first.fitted.sightings.size()) continue;
    const SightingFit& fit = first.fitted.sightings[k];
    enter_figures(fit, outline);
    if (!request.output_path) continue;
    const std::string name = file_stem(outline.image) + "-" + file_stem(outline.object) + "-" + outline.kind + ".csv";
    const auto path = request.output_path(name);
    write_file(path, point_table(in, first.fitted.setting, k, fit));
    outline.file =
        manifest::add_file(document, path, "outline-" + outline.image + "-" + outline.object + "-" + outline.kind);
  }
  if (!request.page.empty()) write_file(request.page, alignment_page(document, in, all));
  return worst;
}

}  // namespace gonio::alignment
