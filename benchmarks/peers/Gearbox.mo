// The paper's setup for Modelica programs: scaled states as in paper_case.py, which fills in the parameters.
model Gearbox
  parameter Real friction = 0;
  parameter Real torque = 1;
  parameter Real base_a = 1, base_b = 1, distance_0 = 1, pitch = 1, curvature_start = 1, alpha_0 = 1;
  parameter Real inertia_a = 1, inertia_b = 1, sliding_mass = 1;
  parameter Real e_star = 1, width = 1, damping = 1, viscous = 1, stiffness = 1, slider_damping = 1, delta = 1;
  parameter Real scale[6] = {1, 1, 1, 1, 1, 1};
  Real y1(start = 0, fixed = true), y2(start = 0, fixed = true), y3(start = 0, fixed = true);
  Real y4(start = 0, fixed = true), y5(start = 0, fixed = true), y6(start = 0, fixed = true);
  discrete Real teeth(start = 0, fixed = true);
  Real theta, omega, psi, psi_rate, s, s_rate;
  Real distance, cosine, sine, curvature_a, arm_a, arm_b, omega_b, depth, depth_rate, sliding;
  Real excess, p, v0, z, q, v, elastic, normal, saturation, tangential, acceleration_a, acceleration_b;
equation
  theta = y1*scale[1];
  omega = y2*scale[2];
  psi = y3*scale[3];
  psi_rate = y4*scale[4];
  s = y5*scale[5];
  s_rate = y6*scale[6];
  distance = distance_0 + s;
  cosine = (base_a + base_b)/distance;
  sine = sqrt(1 - cosine*cosine);
  depth = psi - s*sqrt(1 - ((base_a + base_b)/(distance_0 + s/2))^2);
  depth_rate = psi_rate - s_rate*sine;
  curvature_a = curvature_start + base_a*(acos(cosine) - alpha_0 + theta - teeth*pitch);
  arm_a = curvature_a - depth/2;
  arm_b = distance*sine - arm_a;
  omega_b = (base_a*omega - psi_rate)/base_b;
  sliding = omega_b*arm_b - omega*arm_a - s_rate*cosine;
  excess = -log(exp(1)*noEvent(max(depth, 1e-30))/(4*(distance*sine + depth))) - 1;
  p = sqrt(2*excess);
  v0 = p*(1.000047 + p*(1.583318 + p*(0.6421632 + p*0.09953348)))/(1 + p*(1.249795 + p*0.1994));
  z = v0 - log(1 + v0) - excess;
  q = 2*v0*(v0 - 2/3*z);
  v = v0 - (1 + v0)*z*(q - z)/(v0*(q - 2*z));
  elastic = width*3.141592653589793*e_star*noEvent(max(depth, 0))/(1 + v);
  normal = noEvent(max(elastic + (if depth > 0 then damping*depth_rate else 0), 0));
  saturation = if sliding > delta then 1 elseif sliding < -delta then -1 else sliding/delta;
  tangential = -friction*normal*saturation;
  acceleration_a = (torque - normal*base_a - tangential*arm_a)/inertia_a;
  acceleration_b = (normal*base_b + tangential*arm_b - viscous*omega_b)/inertia_b;
  der(y1) = omega/scale[1];
  der(y2) = acceleration_a/scale[2];
  der(y3) = psi_rate/scale[3];
  der(y4) = (base_a*acceleration_a - base_b*acceleration_b)/scale[4];
  der(y5) = s_rate/scale[5];
  der(y6) = (normal*sine - tangential*cosine - stiffness*s - slider_damping*s_rate)/(sliding_mass*scale[6]);
algorithm
  when theta > (pre(teeth) + 1)*pitch then
    teeth := pre(teeth) + 1;
  end when;
end Gearbox;
