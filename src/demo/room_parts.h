#pragma once
// What demo:room is put together from. Every function adds one thing to the stage, at its place in the room.

#include "demo/shapes.h"

namespace binosplat::demo::room {

using Shape = Solid::Shape;

// The room, in metres, y downwards; the window is in the wall at high z.
constexpr dvec3 room_low{-2.5, -2.8, -2.0};
constexpr dvec3 room_high{2.5, 0.0, 2.0};
constexpr dvec2 window_low{-1.75, -2.4};
constexpr dvec2 window_high{0.35, -0.7};
constexpr dvec3 lamp_bulb{0.95, -1.72, 0.5};

// room_shell.cpp
void add_floor(Stage& stage);
void add_rug(Stage& stage);
void add_walls(Stage& stage);
void add_ceiling(Stage& stage);
void add_window(Stage& stage);
void add_curtains(Stage& stage);

// room_outside.cpp
void add_outside(Stage& stage, const dvec3& to_sun);

// room_furniture.cpp
void add_table(Stage& stage);
void add_chair(Stage& stage, const Frame& frame);
void add_armchair(Stage& stage);
void add_bookshelf(Stage& stage);
void add_lamp(Stage& stage);
void add_pictures(Stage& stage);

// room_things.cpp
void add_table_setting(Stage& stage);
void add_bird_cage(Stage& stage);
void add_fairy_lights(Stage& stage);
void add_toys(Stage& stage);
void add_near_plant(Stage& stage);

}  // namespace binosplat::demo::room
