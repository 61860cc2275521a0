// The choices that options, shader variants and charts name. Plain #defines only: GLSL and C++ include this
// file.
#ifndef BINOSPLAT_SHARED_AXES_H
#define BINOSPLAT_SHARED_AXES_H

// --tiles: which Gaussian-tile pairs are made (METHOD 4).
#define TILES_AABB 0     // the 3-sigma square of 3D-GS (Kerbl 2023); cuts visible tails
#define TILES_ELLIPSE 1  // exact: the level set of alpha against the tile (FlashGS, AdR-Gaussian)
#define TILES_ALL 2      // every Gaussian to every tile: the slow oracle for the exact tests

#endif
