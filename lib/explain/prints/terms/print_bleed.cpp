// print.bleed: a core alone, or with a tail.
#include "print/mechanisms/print_bleed.h"

#include <cmath>

#include "explain/prints/print_term.h"
#include "manifest/sections/print.h"

namespace gonio::explain::prints::terms {

const Term& print_bleed() {
  static const Term term{
      .mechanism = mechanism::print_bleed,
      .forms =
          [](const Sent&) {
            return std::vector<Form>{{{"sigma_m"}, false}, {{"sigma_m", "tail_share", "tail_m"}, true}};
          },
      .bounds =
          [](const Sent& sent) {
            const double pixel_m = sent.printer.pixel_m.x;
            return std::vector<Bounds>{{0, 0, 4 * pixel_m, 0.5 * pixel_m},
                                       {0, 0, 0.6, 0.08},
                                       {2 * pixel_m, 0.5 * pixel_m, 12 * pixel_m, 2 * pixel_m}};
          },
      .set =
          [](Setting& setting, const Sent& sent, const Form&, std::span<const double> p) {
            setting.printer.bleed = equation::print_bleed(sent.printer.bleed, p[0], p[1], p[2]);
          },
      .write =
          [](manifest::Print& print, const Sent& sent, std::span<const double> p, std::span<const double> covariance) {
            const print::Bleed all = equation::print_bleed(sent.printer.bleed, p[0], p[1], p[2]);
            manifest::PrintBleed entry;
            entry.sigma_m = all.sigma_m;
            entry.sigma["sigma_m"] = {all.sigma_m > 0 ? p[0] / all.sigma_m * std::sqrt(covariance[0]) : 0};
            if (all.tail_share > 0) {
              entry.tail_share = all.tail_share, entry.tail_m = all.tail_m;
              entry.sigma["tail_share"] = {std::sqrt(covariance[4])},
              entry.sigma["tail_m"] = {std::sqrt(covariance[8])};
            }
            print.bleed = std::move(entry);
          }};
  return term;
}

}  // namespace gonio::explain::prints::terms
