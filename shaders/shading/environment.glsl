// W/m^2/sr that comes from infinity out of `direction` (unit). Needs lighting/gather.glsl.
vec3 environment_radiance(vec3 direction) { return lighting.environment; }
