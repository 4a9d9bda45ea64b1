// Pieces that stand on each other: does the upper one float or sink? With --settle it comes to rest.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/progress.h"
#include "base/text.h"
#include "manifest/sections/object.h"
#include "manifest/sections/placement.h"
#include "reassembly/lids.h"
#include "tools/reassemble/work.h"

namespace gonio::tools::reassemble {
namespace {

using reassembly::Standing, reassembly::StandingPiece;

struct Stack {
  std::vector<io::TriangleMesh> meshes;
  std::vector<StandingPiece> pieces;
  std::vector<reassembly::Placed*> placed;
};

// Of pieces that stand, lowest first.
Stack stack_of(Work& work) {
  Stack stack;
  for (reassembly::Placed& placed : work.placement.pieces)
    if (placed.verdict == reassembly::Verdict::placed) stack.placed.push_back(&placed);
  const Vec3 up = -work.asked.down;
  std::ranges::stable_sort(stack.placed, {}, [&](const reassembly::Placed* p) { return dot(p->centroid_m, up); });
  for (const reassembly::Placed* p : stack.placed) stack.meshes.push_back(mesh_of(work, p->object));
  for (std::size_t k = 0; k < stack.placed.size(); ++k)
    stack.pieces.push_back({stack.placed[k]->object, &stack.meshes[k], stack.placed[k]->world_from_object,
                            stack.placed[k]->covariance, stack.placed[k]->centroid_m});
  return stack;
}

const char* word_of(Standing standing) {
  switch (standing) {
    case Standing::touches: return "touches it within the uncertainty";
    case Standing::floats: return "floats";
    case Standing::sinks: return "sinks into it";
    case Standing::apart: break;
  }
  return "is not above it";
}

void move_to(Work& work, reassembly::Placed& placed, const Rigid<frame::World, frame::Object>& pose) {
  placed.world_from_object = pose;
  for (manifest::Object& object : work.call.document.objects)
    if (object.id == placed.object) static_cast<Rigid<frame::World, frame::Object>&>(*object.world_from_object) = pose;
  for (manifest::Placement& entry : work.call.document.placements)
    if (entry.object == placed.object)
      static_cast<Rigid<frame::World, frame::Object>&>(*entry.world_from_object) = pose;
}

void enter_contact(Work& work, const std::string& upper, const std::string& lower, const reassembly::Seat& seat,
                   double moved_m) {
  for (manifest::Placement& entry : work.call.document.placements)
    if (entry.object == upper)
      entry.contacts.push_back({.object = lower,
                                .how = work.asked.settle ? "settled" : "",
                                .deepest_m = moved_m,
                                .gap_m = seat.gap_m,
                                .sigma_gap_m = seat.sigma_m});
}

void stand(Work& work, Stack& stack, std::size_t upper, std::size_t lower, const reassembly::Seat& seat) {
  const StandingPiece& above = stack.pieces[upper];
  std::string words = format("%s: gap %.3g +- %.2g mm", word_of(seat.standing), 1e3 * seat.gap_m, 1e3 * seat.sigma_m);
  double moved_m = 0;
  if (work.asked.settle) {
    const reassembly::Settled rest = reassembly::settle(above, stack.pieces[lower], work.asked.down, {}, above.object);
    if (!rest.refused.empty()) {
      work.complaints.push_back(above.object + ": does not come to rest on " + stack.pieces[lower].object + ": " +
                                rest.refused);
      words += "; not moved: " + rest.refused;
    } else {
      moved_m = norm(rest.shift_m);
      words += format("; moved by %.3g mm and %.2g mrad, %.1f standard deviations, to rest on %zu feet", 1e3 * moved_m,
                      1e3 * norm(rest.turn_rad), rest.sigmas, rest.feet_m.size());
      stack.pieces[upper].world_from_object = rest.world_from_object;
      move_to(work, *stack.placed[upper], rest.world_from_object);
    }
  } else if (seat.standing != Standing::touches) {
    log(LogLevel::warning, above.object + " " + words + " over " + stack.pieces[lower].object + "; --settle moves it");
  }
  enter_contact(work, above.object, stack.pieces[lower].object, seat, moved_m);
  work.contacts.push_back(
      {above.object, stack.pieces[lower].object, work.asked.settle ? "settled" : "looked at", words});
}

}  // namespace

void settle(Work& work) {
  Stack stack = stack_of(work);
  for (std::size_t upper = 1; upper < stack.pieces.size(); ++upper) {
    std::optional<std::size_t> on;
    reassembly::Seat nearest;
    for (std::size_t lower = 0; lower < upper; ++lower) {
      const reassembly::Seat seat = reassembly::seat_of(stack.pieces[upper], stack.pieces[lower], work.asked.down);
      if (seat.standing == Standing::apart || (on && std::abs(nearest.gap_m) <= std::abs(seat.gap_m))) continue;
      on = lower, nearest = seat;
    }
    if (on) stand(work, stack, upper, *on, nearest);
  }
}

}  // namespace gonio::tools::reassemble
