// Surfaces for the contrast experiment.
#pragma once
#include <string>

#include "contrast/predict/predict.h"
#include "manifest/document.h"

namespace gonio::tests {

inline manifest::Document document_of(const std::string& surface) {
  return manifest::parse_document("{\"gonio\": 1, \"surfaces\": {\"s\": " + surface + "}}", "test.json", ".");
}
inline contrast::Specimen specimen_of(const std::string& surface) {
  return contrast::Specimen(document_of(surface), "s");
}
inline contrast::Specimen ridged(double alpha_u, double alpha_v, double ridge_degrees = 5, double azimuth_rad = 0,
                                 double walls = 0) {
  return specimen_of("{\"model\": \"ridged\", \"ridge_rad\": " + std::to_string(ridge_degrees * pi / 180) +
                     ", \"alpha_u\": " + std::to_string(alpha_u) + ", \"alpha_v\": " + std::to_string(alpha_v) +
                     ", \"azimuth_rad\": " + std::to_string(azimuth_rad) + ", \"walls\": " + std::to_string(walls) +
                     "}");
}
// The ridge angles of the experiment.
inline contrast::Varied ridge_angles() {
  return {"ridge_rad", {5 * degree, 10 * degree, 15 * degree, 20 * degree}};
}
inline const contrast::Means& means_over(const contrast::Prediction& p, const std::string& what) {
  for (const contrast::Means& m : p.means)
    if (m.over == what) return m;
  throw what;
}

}  // namespace gonio::tests
