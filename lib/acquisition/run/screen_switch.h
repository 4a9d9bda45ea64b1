// The screens of an instrument: what a step asks of them, and black where it asks nothing.
#pragma once
#include <map>
#include <string>

#include "acquisition/run/instrument.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

class ScreenSwitch {
 public:
  ScreenSwitch(Instrument& instrument, const manifest::Document& document)
      : instrument_(instrument), document_(document) {}

  // `wanted`: a file id by screen; Error(data) at `place` for a screen that there is not. Returns once the pictures are
  // steady; what is shown already is not shown again.
  void show(const std::map<std::string, std::string>& wanted, const std::string& place);

 private:
  Instrument& instrument_;
  const manifest::Document& document_;
  std::map<std::string, std::string> shown_;
};

}  // namespace gonio::acquisition
