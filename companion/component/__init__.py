"""The companion as a MAVLink component: what ground stations may ask of it, and what it tells them."""
