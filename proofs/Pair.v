(* Two shielded vehicles in a lane, without C6: whoever leads, the other one has a plan that stays behind. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Statement Ego Plan Apart Entry Shield.
Open Scope R_scope.

Lemma motion_continuous s v x : motion s v -> continuous s x.
Proof. intros m. apply (ex_derive_continuous s). exists (v x). apply (moves s v m). Qed.

(* What is negative at a time stays so for a while. *)
Lemma stays_negative (f : R -> R) g : continuous f g -> f g < 0 -> exists e, 0 < e /\ forall x, g <= x < g + e -> f x < 0.
Proof.
  intros c neg.
  destruct (c (fun y => y < 0)) as [e E].
  { exists (mkposreal (- f g) ltac:(lra)). intros y h. unfold ball in h. cbn in h. unfold AbsRing_ball, abs, minus, plus, opp in h.
    cbn in h. apply Rabs_def2 in h. lra. }
  exists e. split; [apply cond_pos |]. intros x h. apply E.
  unfold ball. cbn. unfold AbsRing_ball, abs, minus, plus, opp. cbn. apply Rabs_def1; lra.
Qed.

(* The first time at which two continuous functions are not negative, if there is one. *)
Lemma first_time (f h : R -> R) from x0 :
  (forall x, continuous f x) -> (forall x, continuous h x) -> from <= x0 -> 0 <= f x0 -> 0 <= h x0 ->
  exists g, from <= g <= x0 /\ 0 <= f g /\ 0 <= h g /\ forall x, from <= x < g -> ~ (0 <= f x /\ 0 <= h x).
Proof.
  intros cf ch le f0 h0.
  set (W := fun y => from <= - y /\ 0 <= f (- y) /\ 0 <= h (- y)).
  destruct (completeness W) as [m [up least_]].
  - exists (- from). intros y [? _]. lra.
  - exists (- x0). unfold W. rewrite Ropp_involutive. auto.
  - assert (below : forall x, from <= x -> 0 <= f x -> 0 <= h x -> - m <= x).
    { intros x ? ? ?. assert (- x <= m); [| lra]. apply up. unfold W. rewrite Ropp_involutive. auto. }
    assert (lo : from <= - m).
    { assert (m <= - from); [| lra]. apply least_. intros y [? _]. lra. }
    assert (near : forall e, 0 < e -> exists x, - m <= x < - m + e /\ 0 <= f x /\ 0 <= h x).
    { intros e e0. destruct (Classical_Prop.classic (exists x, - m <= x < - m + e /\ 0 <= f x /\ 0 <= h x)) as [? | none];
        [assumption | exfalso].
      assert (m <= m - e); [| lra]. apply least_. intros y (wy & fy & hy).
      destruct (Rle_dec y (m - e)) as [? | gt]; [assumption | exfalso]. apply none. exists (- y).
      pose proof (below (- y) wy fy hy). split; [lra | auto]. }
    exists (- m). split; [split; [exact lo | apply below; auto] |]. split; [| split].
    + destruct (Rle_lt_dec 0 (f (- m))) as [? | neg]; [assumption | exfalso].
      destruct (stays_negative f (- m) (cf _) neg) as (e & e0 & E). destruct (near e e0) as (x & hx & ? & _).
      specialize (E x hx). lra.
    + destruct (Rle_lt_dec 0 (h (- m))) as [? | neg]; [assumption | exfalso].
      destruct (stays_negative h (- m) (ch _) neg) as (e & e0 & E). destruct (near e e0) as (x & hx & _ & ?).
      specialize (E x hx). lra.
    + intros x [x1 x2] [fx hx]. pose proof (below x x1 fx hx). lra.
Qed.

(* What a shielded vehicle does, at every time. *)
Lemma shielded_outcome k z s v t w from u :
  valid k -> lane z = true -> motion s v -> motion t w -> shielded k z s v t w from -> s from < s_in z -> from <= u ->
  s u < s_in z \/ s u - t u <= lead_from z \/ s_out z <= s u \/ t_out z <= t u \/
  exists x, from <= x <= u /\ s_in z <= s x /\ lead_to z <= s x - t x.
Proof.
  intros ok la ms mt [(tau & c & l & b & since & -> & st & grid & obey & true & keeps & seen & judges)] before lo.
  destruct (between_calls k tau ok grid since u lo) as (i & hi & hu).
  apply (judged_outcome k s v tau c l) with (b := b) (w := w) (claimed := fun _ => False) (i := i); auto.
Qed.

(* In a lane, if each of the two is, at every time, before the lane, or behind, or past it, or leads or has led. *)
Lemma one_leads z s v t w T :
  lead_from z < s_in z - t_in z < lead_to z -> motion s v -> motion t w ->
  (forall u, T <= u -> s u < s_in z \/ s u - t u <= lead_from z \/ s_out z <= s u \/ t_out z <= t u \/
    exists x, T <= x <= u /\ s_in z <= s x /\ lead_to z <= s x - t x) ->
  (forall u, T <= u -> t u < t_in z \/ lead_to z <= s u - t u \/ t_out z <= t u \/ s_out z <= s u \/
    exists x, T <= x <= u /\ t_in z <= t x /\ s x - t x <= lead_from z) ->
  forall u, T <= u -> ~ inside z (s u) (t u).
Proof.
  intros corner ms mt OE OF u0 lo ins.
  destruct ins as ([si so] & [ti to_] & [l1 l2]).
  destruct (OE u0 lo) as [? | [? | [? | [? | (x & hx & sx & lx)]]]]; try lra.
  destruct (OF u0 lo) as [? | [? | [? | [? | (x' & hx' & sx' & lx')]]]]; try lra.
  assert (cs : forall q, continuous s q) by (intros; apply motion_continuous with v; exact ms).
  assert (ct : forall q, continuous t q) by (intros; apply motion_continuous with w; exact mt).
  assert (cl : forall q, continuous (fun r => s r - t r) q) by (intros; apply (continuous_minus s t); auto).
  (* The first times at which one leads in the lane. *)
  destruct (first_time (fun r => s r - s_in z) (fun r => s r - t r - lead_to z) T x) as (gE & hE & sE & lE & firstE);
    [ intros; apply (continuous_minus s (fun _ => s_in z)); [auto | apply continuous_const]
    | intros; apply (continuous_minus (fun r => s r - t r) (fun _ => lead_to z)); [auto | apply continuous_const]
    | lra | lra | lra |].
  destruct (first_time (fun r => t r - t_in z) (fun r => lead_from z - (s r - t r)) T x') as (gF & hF & sF & lF & firstF);
    [ intros; apply (continuous_minus t (fun _ => t_in z)); [auto | apply continuous_const]
    | intros; apply (continuous_minus (fun _ => lead_from z) (fun r => s r - t r)); [apply continuous_const | auto]
    | lra | lra | lra |].
  assert (cp : forall q, continuity_pt (fun r => s r - t r) q).
  { intros q. apply continuity_pt_filterlim. apply (cl q). }
  destruct (Rle_dec gE gF) as [E_first | F_first].
  - (* On the way from one lead to the other the other one has nothing to rely on. *)
    set (m := (lead_from z + Rmin (lead_to z) (s_in z - t_in z)) / 2).
    assert (M : lead_from z < m /\ m < lead_to z /\ m < s_in z - t_in z) by (unfold m; cases; lra).
    destruct (IVT_gen (fun r => s r - t r) gE gF m) as (u1 & h1 & e1); [exact cp | cases; lra |].
    rewrite Rmin_left, Rmax_right in h1 by lra.
    pose proof (advances s v gE u1 ms ltac:(lra)).
    pose proof (advances s v u1 u0 ms ltac:(lra)). pose proof (advances t w u1 u0 mt ltac:(lra)).
    assert (u1 < gF). { destruct (Req_dec u1 gF) as [-> | ne]; [exfalso; lra | lra]. }
    destruct (OF u1 ltac:(lra)) as [? | [? | [? | [? | (r & hr & tr & lr)]]]]; try lra.
    apply (firstF r ltac:(lra)). lra.
  - set (m := (lead_to z + Rmax (lead_from z) (s_in z - t_in z)) / 2).
    assert (M : lead_from z < m /\ m < lead_to z /\ s_in z - t_in z < m) by (unfold m; cases; lra).
    destruct (IVT_gen (fun r => s r - t r) gF gE m) as (u1 & h1 & e1); [exact cp | cases; lra |].
    rewrite Rmin_left, Rmax_right in h1 by lra.
    pose proof (advances t w gF u1 mt ltac:(lra)).
    pose proof (advances s v u1 u0 ms ltac:(lra)). pose proof (advances t w u1 u0 mt ltac:(lra)).
    assert (u1 < gE). { destruct (Req_dec u1 gE) as [-> | ne]; [exfalso; lra | lra]. }
    destruct (OE u1 ltac:(lra)) as [? | [? | [? | [? | (r & hr & tr & lr)]]]]; try lra.
    apply (firstE r ltac:(lra)). lra.
Qed.

Theorem shielded_vehicles_keep_apart : Theorem2_together.
Proof.
  intros k z y s v t w from from' ok lz ly (m1 & m2 & m3 & m4 & m5 & m6) corner ms mt sh sh' sb tb.
  set (T := Rmax from from') in *.
  assert (T1 : from <= T) by apply Rmax_l. assert (T2 : from' <= T) by apply Rmax_r.
  pose proof (advances s v from T ms T1). pose proof (advances t w from' T mt T2).
  assert (OE : forall u, T <= u -> s u < s_in z \/ s u - t u <= lead_from z \/ s_out z <= s u \/ t_out z <= t u \/
            exists x, T <= x <= u /\ s_in z <= s x /\ lead_to z <= s x - t x).
  { intros u h. destruct (shielded_outcome k z s v t w from u ok lz ms mt sh ltac:(lra) ltac:(lra))
      as [? | [? | [? | [? | (x & hx & sx & lx)]]]]; auto.
    do 4 right. exists x. split; [| auto]. split; [| lra].
    destruct (Rle_dec T x) as [? | before]; [assumption | exfalso].
    pose proof (advances s v x T ms ltac:(lra)). lra. }
  assert (OF : forall u, T <= u -> t u < t_in z \/ lead_to z <= s u - t u \/ t_out z <= t u \/ s_out z <= s u \/
            exists x, T <= x <= u /\ t_in z <= t x /\ s x - t x <= lead_from z).
  { intros u h. destruct (shielded_outcome k y t w s v from' u ok ly mt ms sh' ltac:(lra) ltac:(lra))
      as [? | [? | [? | [? | (x & hx & sx & lx)]]]]; try (rewrite ?m1, ?m2, ?m4, ?m5 in *; auto; fail).
    - right; left. lra.
    - do 4 right. exists x. rewrite m1 in sx. rewrite m6 in lx. split; [| split; lra].
      split; [| lra]. destruct (Rle_dec T x) as [? | before]; [assumption | exfalso].
      pose proof (advances t w x T mt ltac:(lra)). lra. }
  exact (one_leads z s v t w T corner ms mt OE OF).
Qed.

Theorem two_shielded_vehicles : Theorem2_apart.
Proof.
  intros k zones occupied s v t w from from' ok cov ms mt all u lo occ.
  destruct (cov (s u) (t u) occ) as (z & zin & ins). destruct (all z zin) as [sh lanes].
  assert (which : lane z = true \/ lane z = false) by (destruct (lane z); auto).
  destruct which as [la | la].
  - destruct (lanes la) as (corner & sb & tb & y & ly & mir & sh').
    exact (shielded_vehicles_keep_apart k z y s v t w from from' ok la ly mir corner ms mt sh sh' sb tb u lo ins).
  - destruct sh as [(tau & c & l & b & since & -> & st & grid & obey & true & keeps & seen & judges)].
    assert (lo' : tau since <= u) by (apply Rle_trans with (2 := lo); apply Rmax_l).
    destruct (between_calls k tau ok grid since u lo') as (i & hi & hu).
    apply (judged_safe k s v tau c l) with (t := t) (w := w) (b := b) (z := z) (claimed := fun _ => False) (since := since)
      (i := i) (u := u); auto; try (rewrite la; discriminate).
    intros a d _ [].
Qed.
