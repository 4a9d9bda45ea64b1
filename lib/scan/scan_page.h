// What was measured, as a page: which pixels were told and why others were not, the codes, the points' errors, the
// points.
#pragma once
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "report/page.h"
#include "scan/triangulate.h"

namespace gonio::scan {

class ScanPage {
 public:
  // `codes`: of each camera, in the cloud entry's order. `first` as it looks at the points, which are in the rig's
  // frame.
  void add(const std::string& view, const std::vector<std::string>& cameras, const std::vector<Codes>& codes,
           const Sequence& sequence, const Station& first, const Cloud& cloud, const manifest::Cloud& entry);
  std::string html() const;

 private:
  struct View {
    std::string name, headline;
    std::vector<report::KeyNumber> numbers;
    report::TableText refused;
    std::vector<std::vector<report::Figure>> figures;  // of each camera
    report::Figure points, residuals;
    report::ColourScale scale;
  };
  std::vector<View> views_;
};

}  // namespace gonio::scan
