#pragma once

#include "city.h"

namespace hqslam::sim {

/// What stands on blocks that lie level with the street.

/// A field: at its edges a hedge, a fence or telegraph poles here and there, few trees on it, on
/// some a farm.
void add_field(City& city, const Block& block, Random& random);

/// Long smooth walls at the street, cut off at the corners; trees behind them.
void add_smooth_walls(City& city, const Block& block, Random& random);

/// What stands about in a yard: containers, pallets, drums, bollards, a car.
void add_yard(City& city, const Block& block, Random& random);

/// Two rows of cars back to back, their noses to the aisles of axis 0.
void add_parking_rows(City& city, const Block& block, double parked_car_share, Random& random);

}  // namespace hqslam::sim
