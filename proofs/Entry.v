(* (iii), ahead: the gap is verified for the last moment at which the ego may enter a lane. It may enter sooner, and slower. *)
Require Import Reals Lra Lia Psatz.
Require Import Contract Shipped Motion Reach Statement Ego Plan Apart.
Open Scope R_scope.

(* How much farther r' rests than r, braking at b, times twice b. *)
Lemma rest_gain r r' b :
  0 < b -> (rest_of r' b - rest_of r b) * (b + b) =
    (distance r' - distance r) * (b + b) + speed r' * speed r' - speed r * speed r.
Proof. intros. unfold rest_of. field. lra. Qed.

(* L26, L27: in a time y the ego's braking distance grows by no more than the other's way until it rests. *)
Lemma way_grows a B f ah cap vmax r x y v :
  0 < a -> 0 < B -> 0 < f -> a <= ah -> a <= B -> 0 < cap -> vmax <= cap ->
  0 <= speed r -> 0 <= x -> 0 <= y -> y <= x + a * v -> y <= Rmax vmax x -> 0 <= v ->
  (cap <= speed r \/ x * a * f <= B * speed r * (f + ah)) ->
  (y * y - x * x) / (B + B) <= rest_of (rushing r ah cap v) f - rest_of r f.
Proof.
  intros a0 B0 f0 aah aB cap0 vc r0 x0 y0 yv yc v0 slow.
  set (Q := speed r) in *.
  apply Rmult_le_reg_r with ((B + B) * (f + f)); [nra |].
  replace ((y * y - x * x) / (B + B) * ((B + B) * (f + f))) with ((y * y - x * x) * (f + f)) by (field; lra).
  replace ((rest_of (rushing r ah cap v) f - rest_of r f) * ((B + B) * (f + f)))
    with (((rest_of (rushing r ah cap v) f - rest_of r f) * (f + f)) * (B + B)) by ring.
  rewrite rest_gain by assumption. fold Q.
  destruct (Rle_dec y x) as [slower | faster].
  { assert (A : (y * y - x * x) * (f + f) <= 0).
    { assert (y * y <= x * x) by (apply Rmult_le_compat; lra). nra. }
    pose proof (rushing_no_nearer r ah cap v ltac:(lra) v0 r0).
    pose proof (rushing_speed_grows r ah cap 0 v ltac:(lra) v0) as S. rewrite (rushing_speed r ah cap 0) in S.
    fold Q in S. rewrite Rmult_0_r, Rplus_0_r, Rmin_right in S by apply Rmax_r.
    assert (0 <= (distance (rushing r ah cap v) - distance r) * (f + f)) by nra.
    assert (0 <= speed (rushing r ah cap v) * speed (rushing r ah cap v) - Q * Q) by nra.
    apply Rle_trans with 0; [exact A |]. apply Rmult_le_pos; lra. }
  assert (yvm : y <= cap) by (revert yc; cases; lra).
  (* At the highest speed. *)
  assert (steady : forall p q t, 0 <= t -> p <= q -> 0 <= p -> q <= p + a * t -> q <= cap ->
            (q * q - p * p) * (f + f) <= cap * t * (f + f) * (B + B)).
  { intros p q t ? ? ? ? ?.
    assert ((q - p) * (q + p) <= (a * t) * (cap + cap)) by (apply Rmult_le_compat; lra).
    assert (a * t <= B * t) by (apply Rmult_le_compat_r; lra).
    assert ((a * t) * (cap + cap) <= (B * t) * (cap + cap)) by (apply Rmult_le_compat_r; lra).
    nra. }
  destruct (Rle_dec cap Q) as [fast | slowly].
  { assert (C : Rmax cap Q = Q) by (apply Rmax_right; lra).
    destruct (rushing_late r ah cap v ltac:(lra) v0) as [d s].
    { fold Q. rewrite C. assert (0 <= ah * v) by nra. lra. }
    rewrite d, s. fold Q. rewrite C.
    replace (distance r + (Q * Q - Q * Q) / (2 * ah) + Q * (v - (Q - Q) / ah) - distance r) with (Q * v) by (field; lra).
    pose proof (steady x y v v0 ltac:(lra) x0 yv yvm) as S.
    assert (cap * v <= Q * v) by (apply Rmult_le_compat_r; lra).
    assert (cap * v * (f + f) * (B + B) <= Q * v * (f + f) * (B + B)).
    { apply Rmult_le_compat_r; [lra |]. apply Rmult_le_compat_r; lra. }
    lra. }
  destruct slow as [? | slow]; [lra |].
  assert (C : Rmax cap Q = cap) by (apply Rmax_left; lra).
  (* While the other gets faster. *)
  assert (ramp : forall t q, 0 <= t -> x <= q -> q <= x + a * t ->
            (q * q - x * x) * (f + f) <= ((Q + ah * t * (1 / 2)) * t * (f + f) + (Q + ah * t) * (Q + ah * t) - Q * Q) * (B + B)).
  { intros t q ? ? ?.
    assert ((q - x) * (q + x) <= (a * t) * (2 * x + a * t)) by (apply Rmult_le_compat; lra).
    replace (((Q + ah * t * (1 / 2)) * t * (f + f) + (Q + ah * t) * (Q + ah * t) - Q * Q) * (B + B))
      with ((2 * Q * t + ah * t * t) * (f + ah) * (2 * B)) by (field).
    replace ((q * q - x * x) * (f + f)) with ((q - x) * (q + x) * (f + f)) by ring.
    assert (P1 : (q - x) * (q + x) * (f + f) <= (a * t) * (2 * x + a * t) * (f + f)) by (apply Rmult_le_compat_r; lra).
    assert (P2 : x * a * f * (4 * t) <= B * Q * (f + ah) * (4 * t)) by (apply Rmult_le_compat_r; lra).
    assert (P3 : a * a * f <= ah * B * (f + ah)).
    { assert (a * a <= ah * B) by (apply Rmult_le_compat; lra).
      assert (a * a * f <= ah * B * f) by (apply Rmult_le_compat_r; lra).
      assert (0 <= ah * B * ah) by (repeat apply Rmult_le_pos; lra). lra. }
    assert (P4 : a * a * f * (2 * t * t) <= ah * B * (f + ah) * (2 * t * t)) by (apply Rmult_le_compat_r; nra).
    lra. }
  destruct (Rle_dec (Q + ah * v) cap) as [early | late].
  { destruct (rushing_early r ah cap v ltac:(lra) v0) as [d s]; [fold Q; rewrite C; lra |].
    rewrite d, s. fold Q. pose proof (ramp v y v0 ltac:(lra) yv) as S.
    replace (distance r + (Q + ah * v * (1 / 2)) * v - distance r) with ((Q + ah * v * (1 / 2)) * v) by ring. lra. }
  destruct (rushing_late r ah cap v ltac:(lra) v0) as [d s]; [fold Q; rewrite C; lra |].
  rewrite d, s. fold Q. rewrite C.
  set (t := (cap - Q) / ah). assert (T : Q + ah * t = cap) by (unfold t; field; lra).
  assert (t0 : 0 <= t) by (unfold t; apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
  assert (tv : t <= v) by nra.
  set (q := Rmin y (x + a * t)).
  assert (at0 : 0 <= a * t) by nra.
  assert (q1 : x <= q <= y /\ q <= x + a * t) by (unfold q; cases; lra).
  assert (q2 : y <= q + a * (v - t)).
  { unfold q. assert (0 <= a * (v - t)) by nra. cases; lra. }
  pose proof (ramp t q t0 ltac:(lra) ltac:(lra)) as S1. rewrite T in S1.
  pose proof (steady q y (v - t) ltac:(lra) ltac:(lra) ltac:(lra) q2 yvm) as S2.
  replace ((Q + ah * t * (1 / 2)) * t) with ((cap * cap - Q * Q) / (2 * ah)) in S1 by (rewrite <- T; field; lra).
  replace (distance r + (cap * cap - Q * Q) / (2 * ah) + cap * (v - t) - distance r)
    with ((cap * cap - Q * Q) / (2 * ah) + cap * (v - t)) by ring.
  lra.
Qed.

(* L25: an ego for which there is a gap to keep is not much faster than its follower once that has reacted. *)
Lemma slow_ego a B f ah cap w rho x :
  0 < a -> 0 < B -> 0 < f -> a <= ah -> a <= B -> 0 <= x -> 0 <= rho ->
  x * x / (B + B) < rest_of (rushing (start w) ah cap rho) f ->
  cap <= speed (rushing (start w) ah cap rho) \/
  x * a * f <= B * speed (rushing (start w) ah cap rho) * (f + ah).
Proof.
  intros a0 B0 f0 aah aB x0 rho0 gap.
  set (Q := speed (rushing (start w) ah cap rho)) in *.
  destruct (Rle_dec cap Q) as [? | below]; [left; assumption | right].
  assert (W0 : 0 <= speed (start w)) by apply Rmax_r.
  set (W := speed (start w)) in *.
  assert (E : W + ah * rho <= Rmax cap W).
  { destruct (Rle_dec (W + ah * rho) (Rmax cap W)) as [? | n]; [assumption | exfalso]. apply below.
    unfold Q. rewrite rushing_speed. fold W. rewrite Rmin_left by lra. apply Rmax_l. }
  destruct (rushing_early (start w) ah cap rho ltac:(lra) rho0 E) as [d s].
  fold Q W in s. fold W in d. cbn [distance start] in d.
  assert (ar : 0 <= ah * rho) by nra.
  unfold rest_of in gap. fold Q in gap. rewrite d in gap.
  (* x² f â < B Q² (f + â) *)
  assert (G : x * x * f * ah <= B * (Q * Q) * (f + ah)).
  { assert (way : (W + ah * rho * (1 / 2)) * rho * (2 * ah) <= Q * Q) by (rewrite s; nra).
    assert (G1 : x * x / (B + B) * ((B + B) * f * ah) <= (0 + (W + ah * rho * (1 / 2)) * rho + Q * Q / (f + f)) * ((B + B) * f * ah)).
    { apply Rmult_le_compat_r; [repeat apply Rmult_le_pos; lra | lra]. }
    replace (x * x / (B + B) * ((B + B) * f * ah)) with (x * x * f * ah) in G1 by (field; lra).
    replace ((0 + (W + ah * rho * (1 / 2)) * rho + Q * Q / (f + f)) * ((B + B) * f * ah))
      with ((W + ah * rho * (1 / 2)) * rho * (2 * ah) * (B * f) + Q * Q * (B * ah)) in G1 by (field; lra).
    assert ((W + ah * rho * (1 / 2)) * rho * (2 * ah) * (B * f) <= Q * Q * (B * f)) by (apply Rmult_le_compat_r; nra).
    lra. }
  assert (Q0 : 0 <= Q) by (rewrite s; lra).
  apply Rsqr_incr_0_var; [unfold Rsqr | repeat apply Rmult_le_pos; lra].
  (* (x a f)² ≤ a² f B Q² (f + â) / â ≤ (B Q (f + â))² *)
  apply Rmult_le_reg_r with ah; [lra |].
  assert (S1 : x * x * f * ah * (a * a * f) <= B * (Q * Q) * (f + ah) * (a * a * f)).
  { apply Rmult_le_compat_r; [repeat apply Rmult_le_pos; lra | exact G]. }
  assert (S2 : a * a * f <= B * (f + ah) * ah).
  { assert (a * a <= B * ah) by (rewrite (Rmult_comm B); apply Rmult_le_compat; lra).
    assert (a * a * f <= B * ah * f) by (apply Rmult_le_compat_r; lra).
    assert (0 <= B * ah * ah) by (repeat apply Rmult_le_pos; lra). lra. }
  assert (S3 : B * (Q * Q) * (f + ah) * (a * a * f) <= B * (Q * Q) * (f + ah) * (B * (f + ah) * ah)).
  { apply Rmult_le_compat_l; [repeat apply Rmult_le_pos; lra | exact S2]. }
  lra.
Qed.

(* A reach goes on from where it is. *)
Lemma rushing_shift d w ah cap x :
  distance (rushing {| distance := d; speed := w |} ah cap x)
    = d + distance (rushing {| distance := 0; speed := w |} ah cap x) /\
  speed (rushing {| distance := d; speed := w |} ah cap x) = speed (rushing {| distance := 0; speed := w |} ah cap x).
Proof. cbn. split; [ring | reflexivity]. Qed.

(* With the gap that is verified for when the ego has certainly entered, the gap is safe whenever it does enter, by the
   slack at least. *)
Lemma entry_sooner k W gap clears x ve V :
  valid k -> 0 <= x <= clears -> 0 <= ve -> 0 <= V -> grows k ve V (clears - x) ->
  0 <= enters_ahead k gap (rush k W clears) (safe_gap k (speed (rush k W clears)) V) ->
  safe_gap k (speed (rush k W x)) ve <= gap - distance (rush k W x) - slack k.
Proof.
  intros ok [x0 xc] ve0 V0 [g1 g2] spare. unfold enters_ahead in spare.
  rewrite safe_gap_nonneg in * by assumption.
  destruct (hardest_pos k ok) as (B0 & Bb & Bf).
  pose proof ok as ok'. destruct ok'.
  set (ah := other_acceleration k) in *. set (cap := other_max_speed k) in *.
  set (f := follower_braking k) in *. set (rho := follower_reaction k) in *. set (B := hardest k) in *.
  set (R := fun t => rushing (start W) ah cap t).
  assert (st0 : 0 <= speed (start W)) by apply Rmax_r.
  assert (Rpos : forall t, 0 <= t -> 0 <= speed (R t)).
  { intros t ?. unfold R. rewrite rushing_speed. pose proof (Rmax_r cap (speed (start W))).
    assert (0 <= ah * t) by nra. cases; lra. }
  assert (stop : forall t, 0 <= t -> rest_of (rush k (speed (R t)) rho) f = rest_of (R (t + rho)) f - distance (R t)).
  { intros t t0. rewrite rush_is. fold ah cap. unfold R at 2. rewrite <- rushing_on by lra. fold (R t).
    assert (E : R t = {| distance := distance (R t); speed := speed (R t) |}) by (destruct (R t); reflexivity).
    assert (S : start (speed (R t)) = {| distance := 0; speed := speed (R t) |}).
    { unfold start. rewrite Rmax_left by (apply Rpos; lra). reflexivity. }
    rewrite S. rewrite E at 2. destruct (rushing_shift (distance (R t)) (speed (R t)) ah cap rho) as [D U].
    unfold rest_of. rewrite D, U. lra. }
  change (rush k W clears) with (R clears) in *. change (rush k W x) with (R x).
  rewrite stop in * by lra.
  assert (near : distance (R x) <= distance (R clears)) by (apply rushing_grows; lra).
  pose proof (Rmax_r (rest_of (R (clears + rho)) f - distance (R clears) - V * V / (B + B)) 0).
  pose proof (Rmax_l (rest_of (R (clears + rho)) f - distance (R clears) - V * V / (B + B)) 0).
  apply Rmax_lub; [| lra].
  destruct (Rle_dec (rest_of (R (x + rho)) f - distance (R x)) (ve * ve / (B + B))) as [none | some]; [lra |].
  assert (slow : cap <= speed (R (x + rho)) \/
                 ve * ego_acceleration k * f <= B * speed (R (x + rho)) * (f + ah)).
  { assert (E : speed (R (x + rho)) = speed (rushing (start (speed (R x))) ah cap rho)).
    { assert (U : speed (start (speed (R x))) = speed (R x)) by (apply Rmax_left, Rpos; lra).
      unfold R at 1. rewrite <- rushing_on by lra. fold (R x).
      rewrite (rushing_speed (R x)), (rushing_speed (start (speed (R x)))), U. reflexivity. }
    rewrite E. apply slow_ego; auto; try lra. fold (rush k (speed (R x)) rho).
    change (rushing (start (speed (R x))) ah cap rho) with (rush k (speed (R x)) rho).
    rewrite stop by lra. lra. }
  pose proof (way_grows (ego_acceleration k) B f ah cap (ego_max_speed k) (R (x + rho)) ve V (clears - x)) as G.
  assert (unheld k <= ego_max_speed k).
  { unfold unheld. assert (0 <= (ego_acceleration k + ego_braking k) * switching k).
    { unfold switching. apply Rmult_le_pos; lra. }
    assert (0 <= ego_go k * period k) by (apply Rmult_le_pos; lra). lra. }
  assert (E : R (clears + rho) = rushing (R (x + rho)) ah cap (clears - x)).
  { unfold R. rewrite rushing_on by lra. f_equal. ring. }
  rewrite <- E in G.
  specialize (G ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra) ltac:(assumption) ltac:(lra) ltac:(lra)
                (Rpos (x + rho) ltac:(lra)) ltac:(lra) ltac:(lra) ltac:(lra)).
  specialize (G ltac:(apply Rle_trans with (1 := g2); apply Rle_max_compat_r; lra) ltac:(lra) slow).
  replace ((V * V - ve * ve) / (B + B)) with (V * V / (B + B) - ve * ve / (B + B)) in G by (field; lra).
  lra.
Qed.
