// Field tables of the section about pieces that were placed in the world.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/placement.h"

namespace gonio::manifest {

const std::vector<Field<MarkerPair>>& marker_pair_fields() {
  static const std::vector<Field<MarkerPair>> table{
      field("marker", &MarkerPair::marker, "", "id in markers").needed(),
      field("images", &MarkerPair::images, "", "that show it"),
      field("world_m", &MarkerPair::world_m, "m", "where the photographs put its centre, world"),
      field("residual_m", &MarkerPair::residual_m, "m", "distance of the placed marker from there").range(0, infinite),
      field("expected_m", &MarkerPair::expected_m, "m", "rms distance that both covariances let expect")
          .range(0, infinite),
      field("residual_px", &MarkerPair::residual_px, "px", "rms over the images").range(0, infinite),
      field("moves_m", &MarkerPair::moves_m, "m", "by which the piece's markers move (rms) without this one")
          .range(0, infinite)};
  return table;
}

const std::vector<Field<PlacementContact>>& placement_contact_fields() {
  static const std::vector<Field<PlacementContact>> table{
      field("object", &PlacementContact::object, "", "the other object").needed(),
      field("how", &PlacementContact::how, "", "who gave way, and by what rule; left out: nothing was moved")
          .one_of({"push", "elastic", "settled"}),
      field("deepest_m", &PlacementContact::deepest_m, "m", "largest displacement").range(0, infinite),
      field("volume_m3", &PlacementContact::volume_m3, "m^3", "swept by the soft surface").range(0, infinite),
      field("pairs", &PlacementContact::pairs, "", "intersecting triangles before and after").range(0, infinite),
      field("gap_m", &PlacementContact::gap_m, "m", "before: positive, the piece floated; negative, it had sunk"),
      field("sigma_gap_m", &PlacementContact::sigma_gap_m, "m", "one standard deviation of the gap")
          .range(0, infinite)};
  return table;
}

const std::vector<Field<Placement>>& placement_fields() {
  static const std::vector<Field<Placement>> table{
      field("object", &Placement::object, "", "the piece: id in objects").needed(),
      field("evidence", &Placement::evidence, "", "what says where it stands").one_of({"markers"}),
      field("verdict", &Placement::verdict, "", "was it placed?")
          .one_of({"placed", "ambiguous", "mirrored", "scaled", "poor", "lost"})
          .needed(),
      field("why", &Placement::why, "", "in words, where it was not placed"),
      field("world_from_object", &Placement::world_from_object, "", "takes the piece's to world coordinates"),
      field("covariance", &Placement::covariance, "",
            "6 x 6, row by row: of a small motion (rotation vector in rad, then m) in the world at centroid_m"),
      field("centroid_m", &Placement::centroid_m, "m", "of the paired markers, world"),
      field("rms_m", &Placement::rms_m, "m", "distance of the markers in photographs from those placed")
          .range(0, infinite),
      field("expected_m", &Placement::expected_m, "m", "what both covariances let expect of it").range(0, infinite),
      field("chi_square", &Placement::chi_square, "", "of all sightings and of the markers' places").range(0, infinite),
      field("degrees", &Placement::degrees, "", "of freedom of chi_square").range(0, infinite),
      field("scale", &Placement::scale, "", "by which the piece's lengths were, or would have to be, multiplied")
          .positive(),
      sigma_field(&Placement::sigma),
      field("pairs", &Placement::pairs, "", "the piece's markers that photographs show"),
      field("unseen", &Placement::unseen, "", "markers that none shows"),
      field("candidates", &Placement::candidates, "", "where ambiguous: all poses that fit, best first"),
      field("contacts", &Placement::contacts, "", "what it touches, and what gave way")};
  return table;
}

GONIO_RECORD(MarkerPair, marker_pair_fields);
GONIO_RECORD(PlacementContact, placement_contact_fields);
GONIO_RECORD(Placement, placement_fields);

}  // namespace gonio::manifest
