// The field tables of what cloud-register says of views.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/registration.h"

namespace gonio::manifest {
namespace {

constexpr const char* consistency_words =
    "root mean square of points' distances from each other's surfaces, over what is predicted; 1: as stated";
constexpr const char* rigid_words = "what of it motions of whole views would explain: the poses' part, in squares";
constexpr const char* rest_words = "what would be left then: the points' part, in squares";

}  // namespace

const std::vector<Field<RegisteredPair>>& registered_pair_fields() {
  using P = RegisteredPair;
  static const std::vector<Field<P>> table{
      field("clouds", &P::clouds, "", "names of the two").needed(),
      field("overlap", &P::overlap, "", "share of either's points that have the other's surface beside them")
          .range(0, 1),
      field("residuals", &P::residuals, "", "distances that were compared").range(0, infinite),
      field("patches", &P::patches, "", "parts of the surface whose sums count as independent").range(0, infinite),
      field("rms_m", &P::rms_m, "m", "root mean square distance").range(0, infinite),
      field("consistency", &P::consistency, "", consistency_words).range(0, infinite),
      field("typical", &P::typical, "", "the same of the middle half").range(0, infinite),
      field("rigid", &P::rigid, "", rigid_words).range(0, infinite),
      field("rest", &P::rest, "", rest_words).range(0, infinite),
      field("rigid_p", &P::rigid_p, "", "probability that chance alone explains as much").range(0, 1),
      field("shift_m", &P::shift_m, "m", "of the motion that explains it, in the middle of the overlap")
          .range(0, infinite),
      field("turn_rad", &P::turn_rad, "rad", "of that motion").range(0, infinite),
      sigma_field(&P::sigma)};
  return table;
}

const std::vector<Field<RegisteredView>>& registered_view_fields() {
  using V = RegisteredView;
  static const std::vector<Field<V>> table{
      field("cloud", &V::cloud, "", "its name").needed(),
      field("refined_from_stated", &V::refined_from_stated, "",
            "takes its points from where the poses put them, in the world; left out: they stayed"),
      field("centre_m", &V::centre_m, "m", "of its overlaps, in the world"),
      field("shift_m", &V::shift_m, "m", "by which the centre moved"),
      field("turn_rad", &V::turn_rad, "rad", "rotation vector about it"),
      field("covariance", &V::covariance, "", "6 x 6, row by row: of the turn (rad), then of the shift (m)"),
      sigma_field(&V::sigma),
      field("held", &V::held, "", "directions of six in which it is held").range(0, 6),
      field("open", &V::open, "", "what nothing holds, in words: sliding along ..., turning about ...")};
  return table;
}

const std::vector<Field<Registration>>& registration_fields() {
  using R = Registration;
  static const std::vector<Field<R>> table{
      field("verdict", &R::verdict, "", "were views moved?").one_of({"compared", "refined", "refused"}).needed(),
      field("why", &R::why, "", "refused: the reason"),
      field("fixed", &R::fixed, "", "name of the cloud that stays where it is"),
      field("consistency", &R::consistency, "", consistency_words).range(0, infinite),
      field("consistency_before", &R::consistency_before, "", "refined: the same of the stated poses")
          .range(0, infinite),
      field("typical", &R::typical, "", "the same of the middle half").range(0, infinite),
      field("rigid", &R::rigid, "", rigid_words).range(0, infinite),
      field("rest", &R::rest, "", rest_words).range(0, infinite),
      field("rigid_p", &R::rigid_p, "", "probability that chance alone explains as much").range(0, 1),
      sigma_field(&R::sigma),
      field("residuals", &R::residuals, "", "distances that were compared").range(0, infinite),
      field("patches", &R::patches, "", "parts of the surface whose sums count as independent").range(0, infinite),
      field("reach_m", &R::reach_m, "m", "farther apart, points and surfaces are not compared").positive(),
      field("limit_m", &R::limit_m, "m", "a direction is held where motions of points are known to this").positive(),
      field("inflation", &R::inflation, "", "variance of motions, over that of independent distances").positive(),
      field("pairs", &R::pairs, "", "views that overlap"),
      field("views", &R::views, "", "how each was moved")};
  return table;
}

GONIO_RECORD(RegisteredPair, registered_pair_fields);
GONIO_RECORD(RegisteredView, registered_view_fields);
GONIO_RECORD(Registration, registration_fields);

}  // namespace gonio::manifest
