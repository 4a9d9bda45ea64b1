// nrsfm-make for instruments: what deforms as an object that a simulated laboratory photographs (--object), and tracks
// out of photographs (--follow).
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/sequence.h"
#include "nrsfm/files.h"
#include "nrsfm/make/camera_paths.h"
#include "nrsfm/make/flow.h"
#include "nrsfm/make/painted_object.h"
#include "nrsfm/make/photographs.h"
#include "nrsfm/make/selection.h"
#include "stats/intervals.h"
#include "tools/nrsfm-make/call.h"

namespace gonio::tools::nrsfm_make {

using namespace gonio::nrsfm;

namespace {

// Points that enough of the frames show, those that are seen longest first.
std::vector<Eigen::Index> long_enough(const Visible& visible, double least_seen, const std::string& place) {
  std::vector<Eigen::Index> kept = often_seen(visible, least_seen);
  std::ranges::stable_sort(kept, std::greater{}, [&](Eigen::Index p) { return visible.col(p).count(); });
  if (kept.size() < 4)
    throw Error(Exit::data, place,
                format("has %zu points that are followed through %s of %ld frames", kept.size(),
                       least_frames(visible, least_seen).c_str(), static_cast<long>(visible.rows())),
                "take photographs nearer to each other, or lower --least-seen");
  return kept;
}

// Solvers need points in every frame: those in which fewer than eight are followed go.
std::vector<Eigen::Index> frames_with_points(const Visible& visible, const std::string& place) {
  constexpr Eigen::Index least = 8;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index f = 0; f < visible.rows(); ++f)
    if (visible.row(f).count() >= std::min(least, visible.cols())) kept.push_back(f);
  if (kept.size() < 2)
    throw Error(Exit::data, place,
                format("have %zu frames in which %ld points are followed", kept.size(), static_cast<long>(least)),
                "take photographs nearer to each other, or lower --least-seen");
  return kept;
}

// "sheet-circle-pictures", "sheet-circle-geometry"
void enter(cli::Invocation& call, Sequence s, const std::string& tracks_from, std::vector<std::string> notes) {
  const std::string deformation = call.given("object") ? call.text("object") : "photographed";
  s.factors = {{"deformation", deformation},
               {"path", call.text("follow")},
               {"camera", "perspective"},
               {"missing", "with"},
               {"tracks", tracks_from}};
  s.name = deformation + "-" + call.text("follow") + "-" + tracks_from;
  const std::filesystem::path path = call.output_path(s.name + ".mat");
  write_sequence(s, path, "photographs");
  manifest::TrackSequence entry;
  entry.file = manifest::add_file(call.document, path, s.name);
  entry.frames = s.frames(), entry.points = s.points();
  entry.projection = "perspective";
  if (s.truth) entry.truth_frame = "object";
  entry.unit_m = 1;
  entry.missing_share = s.missing_share();
  entry.tracks_from = tracks_from == "pictures" ? "optical-flow" : "geometry";
  entry.factors = s.factors;
  entry.source = "photographs of the manifest";
  entry.notes = std::move(notes);
  call.document.sequences[s.name] = entry;
}

// How large errors are beside what is said of them: root mean square of each coordinate's error over its sigma.
std::string errors_of(const Sequence& s) {
  const TrackErrors errors = track_errors(s);
  const Tracks truth = project(*s.truth, s.cameras, s.projection, *s.pinhole);
  std::vector<double> scores;
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    for (Eigen::Index p = 0; p < s.points(); ++p)
      if (s.visible(f, p) && s.sigma(f, p) > 0)
        scores.push_back((s.tracks - truth).block<2, 1>(2 * f, p).norm() / (std::sqrt(2.0) * s.sigma(f, p)));
  return format("the median error of the tracks is %.2f px, 5 %% exceed %.2f px", errors.median, errors.upper) +
         (scores.empty() ? "" : format("; half of them exceed %.1f times their sigma", stats::median(scores)));
}

}  // namespace

Exit make_object(cli::Invocation& call) {
  const auto kinds = call.texts("kind");
  const std::string id = call.text("object");
  const Animatronic& animatronic = *find_animatronic(kinds.front());
  const DeformingSurface surface = animatronic.make({call.integer("frames"), 4, call.seed});
  const Extent extent = enter_painted(call.document, surface, id, {call.number("grain"), call.seed},
                                      [&call](const std::string& name) { return call.output_path(name); });
  const auto centimetres = [](double metres) { return format("%.1f cm", 100 * metres); };
  log(LogLevel::info, id + " stays within x " + centimetres(extent.lower_m.x()) + " to " +
                          centimetres(extent.upper_m.x()) + ", y " + centimetres(extent.lower_m.y()) + " to " +
                          centimetres(extent.upper_m.y()) + ", z 0 to " + centimetres(extent.upper_m.z()));
  return Exit::done;
}

Exit follow_photographs(cli::Invocation& call) {
  const Photographs photographs(call.document);
  for (const std::filesystem::path& file : photographs.files()) call.note_input(file);
  const FollowOptions options{call.integer("points"), call.integer("every")};
  Progress progress("following", photographs.count());
  const auto picture = [&](std::size_t k) {
    throw_if_interrupted();
    progress.advance();
    return photographs.picture(k);
  };
  const FollowedPoints followed = follow(photographs.count(), picture, options);
  Sequence tracks = photographs.sequence(followed, options.every);
  const std::string place = manifest::place(call.document, "/images");
  if (!call.given("truth")) {
    keep_points(tracks, long_enough(tracks.visible, call.number("least-seen"), place));
    keep_frames(tracks, frames_with_points(tracks.visible, place));
    enter(call, tracks, "pictures", {});
    return Exit::done;
  }
  call.note_input(call.text("truth"));
  const manifest::Document truth = manifest::read_document(call.text("truth"));
  KnownTracks known = with_truth(photographs, followed, std::move(tracks), options.every, truth, call.text("object"));
  const auto kept = long_enough(known.tracks.visible, call.number("least-seen"), place);
  keep_points(known.tracks, kept), keep_points(known.ideal, kept);
  const auto frames = frames_with_points(known.tracks.visible, place);
  const Eigen::Index lacking = known.tracks.frames() - static_cast<Eigen::Index>(frames.size());
  keep_frames(known.tracks, frames), keep_frames(known.ideal, frames);
  std::vector<std::string> notes{errors_of(known.tracks)};
  if (lacking > 0)
    notes.push_back(
        format("%ld frames in which fewer than 8 points are followed are left out", static_cast<long>(lacking)));
  if (known.elsewhere > 0)
    notes.push_back(format("%ld corners beside the object are left out", static_cast<long>(known.elsewhere)));
  log(LogLevel::info, call.text("follow") + ": " + notes.front());
  enter(call, std::move(known.tracks), "pictures", std::move(notes));
  enter(call, std::move(known.ideal), "geometry", {});
  return Exit::done;
}

}  // namespace gonio::tools::nrsfm_make
