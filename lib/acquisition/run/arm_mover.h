// Moves the arms of an instrument along judged ways, and believes no motion that was not read back.
#pragma once
#include "acquisition/laboratory/laboratory.h"
#include "acquisition/motion/way.h"
#include "acquisition/run/instrument.h"

namespace gonio::acquisition {

class ArmMover {
 public:
  // All are kept by reference.
  ArmMover(const Laboratory& laboratory, const Surroundings& surroundings, Instrument& instrument)
      : laboratory_(laboratory), surroundings_(surroundings), instrument_(instrument) {}

  // Where the arms stand, as they say now. Error(unavailable) for one that is stopped, without power or moving.
  State stands();

  // Along `way`, from where the arms stand (its first state, within 1e-3 rad: else Error(data)). Every limit is checked
  // before anything is sent: Error(data) with the fault, and nothing moves. Arms that move together do so state by
  // state, their speeds matched so that they arrive together, and only where the way stays free though one of them be
  // ahead of the other by a fifth of a motion; else one after the other where that is free; else nothing moves.
  // Anything unexpected stops all arms: Error(unavailable) says why.
  void go(const Way& way);

  // From anywhere to `goal`: the straight line in joint space where that is free, else a way that is searched for.
  void return_to(const State& goal, std::uint64_t seed);

  void stop_all() noexcept;  // at once; from any thread

 private:
  void move_together(const State& from, const State& to);
  void move_one(const std::string& arm, const State& from, const State& to, double slower);

  const Laboratory& laboratory_;
  const Surroundings& surroundings_;
  Instrument& instrument_;
};

}  // namespace gonio::acquisition
