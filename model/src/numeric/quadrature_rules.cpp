#include "numeric/quadrature_rules.hpp"

#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace fringe::detail {
namespace {

struct LegendreValue {
  long double value;
  long double derivative;
};

/// Evaluates the Legendre polynomial of the given degree and its derivative at x inside (−1, 1).
LegendreValue legendre(int degree, long double x) {
  long double previous = 1, current = x;
  for (int n = 2; n <= degree; ++n) {
    const long double next = ((2 * n - 1) * x * current - (n - 1) * previous) / n;
    previous = current;
    current = next;
  }
  return {current, degree * (x * current - previous) / (x * x - 1)};
}

}  // namespace

GaussRule gauss_rule(int points) {
  GaussRule rule;
  for (int i = 0; i < points; ++i) {
    // Chebyshev's estimate of the root lies where Newton's method converges quadratically: five steps reach
    // the last bit.
    long double x = -std::cos(std::numbers::pi_v<long double> * (i + 0.75L) / (points + 0.5L));
    for (int step = 0; step < 5; ++step) {
      const auto [value, derivative] = legendre(points, x);
      x -= value / derivative;
    }
    const long double derivative = legendre(points, x).derivative;
    rule.push_back(
        {static_cast<double>((1 + x) / 2), static_cast<double>(1 / ((1 - x * x) * derivative * derivative))});
  }
  return rule;
}

namespace {

/// Three points that turn into each other, by the barycentric coordinates of the first.
struct Orbit {
  double first;
  double second;
  double third;
  double weight;
};

/// Returns the nodes of a rule: the centroid if it has a weight, then those of the orbits.
template <std::size_t points>
consteval std::array<TriangleNode, points> rule_nodes(double weight_of_centroid,
                                                      std::initializer_list<Orbit> orbits) {
  std::array<TriangleNode, points> nodes{};
  std::size_t count = 0;
  if (weight_of_centroid > 0)
    nodes[count++] = {1.0 / 3, 1.0 / 3, weight_of_centroid};
  for (const auto& [a, b, c, weight] : orbits)
    for (const TriangleNode& node : {TriangleNode{b, c, weight}, {c, a, weight}, {a, b, weight}})
      nodes[count++] = node;
  return nodes;
}

// The rules have the fewest points known for their degrees, with positive weights and all points inside. The
// equations of their moments were solved to 40 digits.

constexpr auto degree1 = rule_nodes<1>(1.0, {});

constexpr auto degree2 =
    rule_nodes<3>(0, {{0.16666666666666667, 0.16666666666666667, 0.66666666666666667, 0.33333333333333333}});

constexpr auto degree4 =
    rule_nodes<6>(0, {{0.091576213509770743, 0.091576213509770743, 0.81684757298045851, 0.10995174365532187},
                      {0.44594849091596489, 0.44594849091596489, 0.10810301816807023, 0.22338158967801147}});

constexpr auto degree5 = rule_nodes<7>(
    0.225, {{0.10128650732345634, 0.10128650732345634, 0.79742698535308732, 0.12593918054482715},
            {0.47014206410511509, 0.47014206410511509, 0.05971587178976982, 0.13239415278850618}});

constexpr auto degree7 =
    rule_nodes<12>(0, {{0.034324302945097146, 0.3047265008681672, 0.66094919618673566, 0.057550085569963171},
                       {0.062382265094402118, 0.8700998678316818, 0.067517867073916085, 0.053034056314872503},
                       {0.055225456656926612, 0.62327204949109157, 0.32150249385198182, 0.08776281742889211},
                       {0.20644149867001644, 0.27771616697639178, 0.51584233435359178, 0.13498637401960555}});

constexpr auto degree8 =
    rule_nodes<16>(0.14431560767778717,
                   {{0.45929258829272316, 0.45929258829272316, 0.081414823414553688, 0.095091634267284625},
                    {0.17056930775176021, 0.17056930775176021, 0.65886138449647959, 0.10321737053471825},
                    {0.050547228317030975, 0.050547228317030975, 0.89890554336593805, 0.03245849762319808},
                    {0.0083947774099576053, 0.26311282963463811, 0.72849239295540428, 0.027230314174434994},
                    {0.26311282963463811, 0.0083947774099576053, 0.72849239295540428, 0.027230314174434994}});

constexpr auto degree9 =
    rule_nodes<19>(0.097135796282798834,
                   {{0.18820353561903273, 0.18820353561903273, 0.62359292876193454, 0.079647738927210253},
                    {0.48968251919873763, 0.48968251919873763, 0.020634961602524744, 0.031334700227139071},
                    {0.43708959149293664, 0.43708959149293664, 0.12582081701412673, 0.077827541004774279},
                    {0.04472951339445271, 0.04472951339445271, 0.91054097321109458, 0.025577675658698031},
                    {0.2219629891607657, 0.036838412054736284, 0.74119859878449802, 0.043283539377289377},
                    {0.036838412054736284, 0.2219629891607657, 0.74119859878449802, 0.043283539377289377}});

constexpr auto degree10 =
    rule_nodes<25>(0.083219736986450142,
                   {{0.16291311787409476, 0.16291311787409476, 0.67417376425181049, 0.052651949468244594},
                    {0.028503500288387836, 0.028503500288387836, 0.94299299942322433, 0.010951288340268411},
                    {0.15330305516956137, 0.033685698680610287, 0.81301124614982834, 0.029322864095652236},
                    {0.033685698680610287, 0.15330305516956137, 0.81301124614982834, 0.029322864095652236},
                    {0.029307604504579472, 0.36336261699457053, 0.60732977850085, 0.035394947791538391},
                    {0.36336261699457053, 0.029307604504579472, 0.60732977850085, 0.035394947791538391},
                    {0.33669587527823165, 0.14681150539393041, 0.51649261932783794, 0.05627727971081118},
                    {0.14681150539393041, 0.33669587527823165, 0.51649261932783794, 0.05627727971081118}});

constexpr TriangleRule rules[] = {
    {1, 1, 2.5250e-01, degree1.data()},  {2, 3, 2.7952e-01, degree2.data()},
    {4, 6, 1.4074e-01, degree4.data()},  {5, 7, 9.7651e-02, degree5.data()},
    {7, 12, 6.2404e-02, degree7.data()}, {8, 16, 5.1346e-02, degree8.data()},
    {9, 19, 4.2457e-02, degree9.data()}, {10, 25, 3.5889e-02, degree10.data()},
};

}  // namespace

std::span<const TriangleRule> triangle_rules() {
  return rules;
}

}  // namespace fringe::detail
