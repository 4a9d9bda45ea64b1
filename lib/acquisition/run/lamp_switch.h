// The lamps of an instrument: switched and read back. A lamp that does not obey is switched off and tried again.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "acquisition/run/instrument.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

class LampSwitch {
 public:
  // `tries` of one lamp, after which its Error(unavailable) passes; `failed` is told of each in vain, lamp and reason.
  LampSwitch(Instrument& instrument, const manifest::Laboratory& laboratory, int tries,
             std::function<void(const std::string&, const std::string&)> failed)
      : instrument_(instrument), laboratory_(laboratory), tries_(tries), failed_(std::move(failed)) {}

  void set(const std::vector<std::string>& on);  // these and no others; returns once their light is steady
  std::vector<std::string> on() const;           // as they say
  bool all_answer(const std::vector<std::string>& names) const;

 private:
  void set_one(const std::string& name, LampDevice& lamp, bool wanted);
  Instrument& instrument_;
  const manifest::Laboratory& laboratory_;
  int tries_;
  std::function<void(const std::string&, const std::string&)> failed_;
};

}  // namespace gonio::acquisition
